"""A campaign's rows as DuckDB, pandas and polars read them: the same as its CSV. Needs those packages and pyarrow.

    python tests/campaign/readers.py CAMPAIGN-FOLDER
"""

import csv
import pathlib
import sys

import duckdb
import pandas
import polars

folder = pathlib.Path(sys.argv[1])
with open(folder / "rows.csv", newline="") as file:
    rows = list(csv.DictReader(file))
parquet = str(folder / "rows.parquet")
readers = {
    "DuckDB " + duckdb.__version__: duckdb.sql(f"select * from '{parquet}' order by run").fetchdf(),
    "pandas " + pandas.__version__: pandas.read_parquet(parquet),
    "polars " + polars.__version__: polars.read_parquet(parquet).to_pandas(),
}
for name, frame in readers.items():
    frame = frame.sort_values("run", kind="stable")
    assert list(frame.columns) == list(rows[0]), (name, list(frame.columns))
    assert len(frame) == len(rows), name
    for column in rows[0]:
        for written, read in zip([row[column] for row in rows], frame[column]):
            if written == "":
                assert read == "" or pandas.isna(read), (name, column, read)
            elif isinstance(read, str):
                assert read == written, (name, column, read, written)
            else:
                assert float(read) == float(written), (name, column, read, written)
    print(f"{name}: {len(frame)} rows of {len(frame.columns)} columns, each as in the CSV")
