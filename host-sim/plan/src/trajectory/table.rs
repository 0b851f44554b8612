//! Tables as text: the text of spreadsheets and scripts in, rows of cells with their lines out.
//!
//! The first line with content decides the separator of columns: tabs, semicolons, commas or spaces. Quotes, trailing
//! separators, blank lines, lines that begin with `#`, CRLF, a byte order mark, and an unnamed index in the first column
//! are taken off; a comment may be the header. Where a comma does not separate columns, it is a decimal comma.

/// The separator of a table's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    Tab,
    Semicolon,
    Comma,
    Spaces,
}

/// A line of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    /// From 1.
    pub(crate) line: usize,
    /// The text of its columns, without spaces around.
    pub(crate) cells: Vec<String>,
}

/// A table, its header apart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table {
    pub(crate) separator: Separator,
    pub(crate) header: Option<Row>,
    pub(crate) rows: Vec<Row>,
}

/// How the first column is called when it counts the rows: by pandas, by R and by hand.
const INDEX_NAMES: [&str; 4] = ["", "unnamed: 0", "index", "#"];

impl Table {
    /// Reads a text; `None` if nothing in it has content.
    pub(crate) fn of(text: &str) -> Option<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = content(text).peekable();
        let separator = Separator::of(lines.peek()?.1);
        let mut rows: Vec<Row> = lines.map(|(line, row)| Row { line, cells: separator.cells(row) }).collect();
        let header = is_header(&rows[0].cells).then(|| rows.remove(0));
        let mut table = Self { separator, header, rows };
        if table.has_index() {
            table.header.iter_mut().chain(&mut table.rows).for_each(|row| drop(row.cells.remove(0)));
        }
        Some(table)
    }

    /// The same of a text whose header may be a comment, as NumPy writes it: the last one above the first row, if most of its words,
    /// three or more, are names of columns.
    pub(crate) fn of_named(text: &str, is_name: impl Fn(&str) -> bool) -> Option<Self> {
        let mut table = Self::of(text)?;
        if table.header.is_none() {
            let first = table.rows.first().map_or(0, |row| row.line);
            let comment = text.lines().zip(1..).take_while(|(_, line)| *line < first).filter_map(|(text, line)| {
                let words =
                    text.trim_start_matches(['\u{feff}', ' ']).strip_prefix('#')?.trim_matches(['#', ' ', '\r']);
                (!words.is_empty()).then_some((words, line))
            });
            table.header = comment.last().and_then(|(words, line)| {
                let cells = Separator::of(words).cells(words);
                let names = cells.iter().filter(|cell| is_name(&cell.to_lowercase())).count();
                (cells.len() > 2 && 2 * names > cells.len()).then_some(Row { line, cells })
            });
        }
        Some(table)
    }

    /// Whether the first column counts the rows: its name says so, and below it are whole numbers one after the other.
    fn has_index(&self) -> bool {
        let named =
            |header: &Row| header.cells.len() > 1 && INDEX_NAMES.contains(&header.cells[0].to_lowercase().as_str());
        let first = self.rows.first().and_then(|row| row.cells.first()?.parse::<u64>().ok());
        let counts = first.is_some_and(|first| {
            let follows =
                |(row, number): (&Row, u64)| row.cells.first().is_some_and(|cell| *cell == number.to_string());
            self.rows.iter().zip(first..).all(follows)
        });
        counts && self.header.as_ref().is_some_and(named)
    }

    /// Names of the columns in lower case; empty without a header.
    pub(crate) fn names(&self) -> Vec<String> {
        self.header.as_ref().map_or_else(Vec::new, |row| row.cells.iter().map(|name| name.to_lowercase()).collect())
    }

    /// Columns of the header, else of the first row.
    pub(crate) fn columns(&self) -> usize {
        self.header.as_ref().or_else(|| self.rows.first()).map_or(0, |row| row.cells.len())
    }
}

impl Separator {
    fn of(line: &str) -> Self {
        let unquoted: String = line.split('"').step_by(2).collect();
        if unquoted.contains('\t') {
            Self::Tab
        } else if unquoted.contains(';') {
            Self::Semicolon
        } else if unquoted.contains(',') {
            Self::Comma
        } else {
            Self::Spaces
        }
    }

    /// The cells of a line without the empty ones that trailing separators leave.
    fn cells(self, line: &str) -> Vec<String> {
        let (delimiter, line) = match self {
            Self::Tab => (b'\t', line.to_owned()),
            Self::Semicolon => (b';', line.to_owned()),
            Self::Comma => (b',', line.to_owned()),
            Self::Spaces => (b' ', line.split_whitespace().collect::<Vec<_>>().join(" ")),
        };
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .buffer_capacity(line.len().max(1))
            .from_reader(line.as_bytes());
        // A line of text is a record, quotes or not.
        let record = reader.records().next().and_then(Result::ok).unwrap_or_default();
        let mut cells: Vec<String> = record.iter().map(str::to_owned).collect();
        while cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        cells
    }
}

/// Content lines with their numbers: no blank lines, no comments.
fn content(text: &str) -> impl Iterator<Item = (usize, &str)> {
    (text.lines().enumerate())
        .map(|(i, line)| (i + 1, line.trim_matches([' ', '\r'])))
        .filter(|(_, line)| !line.trim_matches([',', ';', '\t', ' ', '"']).is_empty() && !line.starts_with('#'))
}

/// A header has words where a row has numbers; one word among numbers is a slip in a row.
fn is_header(cells: &[String]) -> bool {
    let words = cells.iter().filter(|cell| number(cell).is_none() && !cell.is_empty()).count();
    2 * words > cells.len()
}

/// A cell as a number, which may be written with a decimal comma.
pub(crate) fn number(cell: &str) -> Option<f64> {
    let decimal_comma = cell.matches(',').count() == 1 && !cell.contains('.');
    if decimal_comma { cell.replace(',', ".").parse().ok() } else { cell.parse().ok() }
}

/// A cell as a finite number.
pub(crate) fn finite(cell: &str) -> Option<f64> {
    number(cell).filter(|value| value.is_finite())
}

/// As much of a cell as fits an error of one line.
pub(crate) fn shortened(cell: &str) -> String {
    const LONGEST: usize = 40;
    if cell.chars().count() <= LONGEST { cell.into() } else { cell.chars().take(LONGEST).chain(['\u{2026}']).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(text: &str) -> Vec<Vec<String>> {
        Table::of(text).map(|table| table.rows.into_iter().map(|row| row.cells).collect()).unwrap_or_default()
    }

    #[test]
    fn separators_quotes_and_an_index_are_taken_off() {
        let expected = [["1", "2.5"], ["3", "4"]];
        for text in [
            "a,b\n1,2.5\n3,4\n",
            "a;b;\n1;2.5;\n3;4;\n",
            "\u{feff}a\tb\r\n1\t2.5\r\n\r\n3\t4\r\n",
            "# c\n\"a\" , \"b\"\n\"1\",\"2.5\"\n 3 , 4\n",
            "a b\n1   2.5\n3 4\n",
            ",a,b\n0,1,2.5\n1,3,4\n",
            "Unnamed: 0;a;b\n5;1;2.5\n6;3;4\n",
        ] {
            assert_eq!(cells(text), expected, "{text}");
        }
        // A first column that does not count is data, under any name.
        assert_eq!(cells(",a,b\n0.5,1,2\n")[0], ["0.5", "1", "2"]);
        assert_eq!(Table::of("\n# nothing\n,,\n"), None);
    }

    #[test]
    fn a_comment_that_names_the_columns_is_the_header() {
        let header = |text| Table::of_named(text, |name| ["t", "x", "y"].contains(&name)).unwrap().header;
        let named = header("# a flight\n# T,x,y,w\n0,1,2,3\n").unwrap();
        assert_eq!((named.line, named.cells.join(" ")), (2, "T x y w".to_owned()));
        assert_eq!(header("#t x y\n0,1,2\n").unwrap().cells.len(), 3, "whatever separates them");
        for prose in
            ["# x and y of a flight\n0,1,2\n", "# t\n0,1,2\n", "0,1,2\n# t,x,y\n3,4,5\n", "# t,x,y\n# raw\n0,1,2\n"]
        {
            assert_eq!(header(prose), None, "{prose}");
        }
        assert_eq!(header("# t,x,y\na,b,c\n0,1,2\n").unwrap().line, 2, "one that is none comes first");
    }

    #[test]
    fn lines_are_those_of_the_file() {
        let table = Table::of("# c\n\na,b\n1,2\n\n# d\n3,4").unwrap();
        assert_eq!(table.header.map(|row| row.line), Some(3));
        assert_eq!(table.rows.iter().map(|row| row.line).collect::<Vec<_>>(), [4, 7]);
    }

    #[test]
    fn a_comma_that_separates_nothing_is_decimal() {
        assert_eq!(number("0,5"), Some(0.5));
        assert_eq!(number("-1,5e-3"), Some(-0.0015));
        assert_eq!(number("1,000.5"), None);
        assert_eq!(cells("a;b\n0,5;1,25\n"), [["0,5", "1,25"]]);
        assert_eq!(cells("a,b\n\"0,5\",1\n"), [["0,5", "1"]]);
    }
}
