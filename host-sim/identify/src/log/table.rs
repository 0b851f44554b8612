//! CSV with a row of names: bytes in, series out.

use std::collections::BTreeMap;

use super::{RawLog, Series};
use crate::IdentifyError;

pub(super) fn parse(bytes: &[u8], name: &str) -> Result<RawLog, IdentifyError> {
    let format = |reason: String| IdentifyError::Format { path: name.to_owned(), reason };
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).comment(Some(b'#')).from_reader(bytes);
    let headers: Vec<String> = reader
        .headers()
        .map_err(|error| format(format!("no row of column names ({error}); a log is CSV with one")))?
        .iter()
        .map(|header| header.trim_start_matches('\u{feff}').to_owned())
        .collect();
    let mut columns = vec![Vec::new(); headers.len()];
    let mut record = csv::ByteRecord::new();
    while reader.read_byte_record(&mut record).map_err(|error| format(format!("not a CSV file ({error})")))? {
        for (i, column) in columns.iter_mut().enumerate() {
            let value =
                record.get(i).and_then(|cell| std::str::from_utf8(cell).ok()).and_then(|text| text.parse().ok());
            column.push(value.unwrap_or(f64::NAN));
        }
    }
    let rows = columns.first().map_or(0, Vec::len);
    if rows < 100 {
        return Err(format(format!("{rows} rows: a log has at least 100 under its row of column names")));
    }
    let series: BTreeMap<String, Series> =
        headers.into_iter().zip(columns).map(|(name, values)| (name, Series { times: Vec::new(), values })).collect();
    Ok(RawLog { name: name.to_owned(), series, timed: false })
}
