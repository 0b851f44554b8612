//! CSV with a row of names: bytes in, series out. Columns are separated by commas, or by semicolons or tabs where the row of
//! names has one; a comma that does not separate them is a decimal comma.

use std::collections::BTreeMap;

use super::{RawLog, Series};
use crate::IdentifyError;

pub(super) fn parse(bytes: &[u8], name: &str) -> Result<RawLog, IdentifyError> {
    let format = |reason: String| IdentifyError::Format { path: name.to_owned(), reason };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter(bytes))
        .trim(csv::Trim::All)
        .flexible(true)
        .comment(Some(b'#'))
        .from_reader(bytes);
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
            let text = record.get(i).and_then(|cell| std::str::from_utf8(cell).ok());
            let value = text.and_then(|text| text.parse().or_else(|_| text.replacen(',', ".", 1).parse()).ok());
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

/// The separator of the columns, by the row of their names.
fn delimiter(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|byte| *byte == b'\n');
    let header = lines.find(|line| !line.trim_ascii().is_empty() && !line.starts_with(b"#")).unwrap_or_default();
    b"\t;".iter().copied().find(|separator| header.contains(separator)).unwrap_or(b',')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_of_a_spreadsheet_is_that_of_a_script() {
        let text: String = (0..100).map(|row| format!("{row},{}.5,-0.25\n", 2 * row)).collect();
        let text = format!("# a log\nt_us,state x,gyro.x\n{text}");
        let by_commas = parse(text.as_bytes(), "log").unwrap();
        assert_eq!(by_commas.series["state x"].values[3], 6.5);
        let semicolons = text.replace(',', ";").replace('.', ",").replace("gyro,x", "gyro.x");
        for other in [semicolons, text.replace(',', "\t"), format!("\u{feff}{}", text.replace("# a log\n", ""))] {
            assert_eq!(parse(other.as_bytes(), "log").unwrap(), by_commas, "{other}");
        }
    }
}
