//! Waypoints as rows, as `uav_trajectories` and spreadsheets have them: text in, places and, if given, times out.
//!
//! Columns are `t,x,y,z` or `t,x,y,z,yaw` with times in s, or `x,y,z`, with a header, which may be a comment, or without; m and rad,
//! `yaw_deg` is in degrees. Separators and the like are those of a table of rows.

use nalgebra::Vector3;

use super::table::{Row, Table, finite, shortened};

/// A row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaypointRow {
    /// The line in the file, from 1.
    pub line: usize,
    /// The time, s.
    pub time_s: Option<f64>,
    /// The position, m.
    pub position_m: Vector3<f64>,
    /// Heading, rad; turns count.
    pub yaw_rad: Option<f64>,
}

/// Why a text holds no waypoints. Lines count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WaypointsError {
    /// Other columns.
    #[error("needs the columns t,x,y,z or t,x,y,z,yaw, or x,y,z without times (s, m, rad); has {0}")]
    Columns(String),
    /// Two columns of one quantity.
    #[error("{0} is given twice; keep one of the columns")]
    Twice(&'static str),
    /// A row that is too short or too long.
    #[error("line {line}: {found} columns where {expected} are expected")]
    Ragged {
        /// The line, from 1.
        line: usize,
        /// Its number of columns.
        found: usize,
        /// The others' number of columns.
        expected: usize,
    },
    /// A cell that is not a finite number.
    #[error("line {line}: {found:?} is not a finite number; write one such as 0.25")]
    Number {
        /// The line, from 1.
        line: usize,
        /// The text there, shortened.
        found: String,
    },
}

/// The quantity of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Column {
    Time,
    Axis(usize),
    Yaw,
    YawDegrees,
    /// Something that waypoints do not have.
    Other,
}

impl Column {
    const fn quantity(self) -> &'static str {
        match self {
            Self::Time => "the time",
            Self::Axis(0) => "x",
            Self::Axis(1) => "y",
            Self::Axis(_) => "z",
            Self::Yaw | Self::YawDegrees => "the yaw",
            Self::Other => "another quantity",
        }
    }
}

/// The kind of rows, by their columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Places to pass.
    Waypoints {
        /// Whether with times.
        timed: bool,
    },
    /// A flight recorded or sampled: more than places and times.
    Samples,
}

fn column(name: &str) -> Column {
    let words: Vec<&str> = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()).collect();
    match words.join("_").as_str() {
        "t" | "t_s" | "time" | "time_s" | "timestamp" | "timestamp_s" | "sec" | "seconds" => Column::Time,
        "x" | "x_m" | "px" | "pos_x" | "position_x" => Column::Axis(0),
        "y" | "y_m" | "py" | "pos_y" | "position_y" => Column::Axis(1),
        "z" | "z_m" | "pz" | "pos_z" | "position_z" => Column::Axis(2),
        "yaw" | "yaw_rad" | "heading" | "heading_rad" | "psi" => Column::Yaw,
        "yaw_deg" | "heading_deg" => Column::YawDegrees,
        _ => Column::Other,
    }
}

fn columns(table: &Table) -> Vec<Column> {
    if table.header.is_some() {
        return table.names().iter().map(|name| column(name)).collect();
    }
    let axes = [Column::Axis(0), Column::Axis(1), Column::Axis(2)];
    match table.columns() {
        3 => axes.to_vec(),
        4 => [&[Column::Time][..], &axes].concat(),
        5 => [&[Column::Time][..], &axes, &[Column::Yaw]].concat(),
        count => vec![Column::Other; count],
    }
}

/// The kind of a table's rows; `None` if none of these.
pub(super) fn recognise(table: &Table) -> Option<Kind> {
    let columns = columns(table);
    let has = |column| columns.contains(&column);
    let timed = has(Column::Time);
    let placed = (0..3).all(|axis| has(Column::Axis(axis)));
    if placed {
        let more = columns.contains(&Column::Other);
        return Some(if more { Kind::Samples } else { Kind::Waypoints { timed } });
    }
    // Numbers without names: a time that grows, and more than places.
    let times: Option<Vec<f64>> = table.rows.iter().map(|row| finite(row.cells.first()?)).collect();
    let grows = times.is_some_and(|times| times.len() > 2 && times.windows(2).all(|pair| pair[0] < pair[1]));
    (table.header.is_none() && (6..25).contains(&table.columns()) && grows).then_some(Kind::Samples)
}

/// Reads the text of a whole file.
///
/// # Errors
/// [`WaypointsError`] for the first line that cannot be used.
pub fn parse(text: &str) -> Result<Vec<WaypointRow>, WaypointsError> {
    let Some(table) = Table::of_named(text, is_name) else {
        return Err(WaypointsError::Columns("nothing".into()));
    };
    let columns = columns(&table);
    if !matches!(recognise(&table), Some(Kind::Waypoints { .. })) {
        let found = match &table.header {
            Some(header) => shortened(&header.cells.join(",")),
            None => format!("{} columns without names", table.columns()),
        };
        return Err(WaypointsError::Columns(found));
    }
    for (index, column) in columns.iter().enumerate() {
        if columns[..index].iter().any(|before| before.quantity() == column.quantity()) {
            return Err(WaypointsError::Twice(column.quantity()));
        }
    }
    table.rows.iter().map(|row| waypoint(&columns, row)).collect()
}

/// Whether a name of a column, in lower case, is one that waypoints have.
pub(super) fn is_name(name: &str) -> bool {
    column(name) != Column::Other
}

/// Whether a text is rows of waypoints, rather than anything else that is read.
pub fn recognises(text: &str) -> bool {
    Table::of_named(text, is_name).is_some_and(|table| matches!(recognise(&table), Some(Kind::Waypoints { .. })))
}

/// Whether a text is rows of numbers, three or more a row, under names that are none of waypoints or of a sampled flight.
pub fn are_numbers(text: &str) -> bool {
    let are_numbers = |row: &Row| row.cells.len() > 2 && row.cells.iter().all(|cell| finite(cell).is_some());
    Table::of_named(text, is_name).is_some_and(|table| {
        recognise(&table).is_none() && !table.rows.is_empty() && table.rows.iter().all(are_numbers)
    })
}

fn waypoint(columns: &[Column], Row { line, cells }: &Row) -> Result<WaypointRow, WaypointsError> {
    if cells.len() != columns.len() {
        return Err(WaypointsError::Ragged { line: *line, found: cells.len(), expected: columns.len() });
    }
    let mut row = WaypointRow { line: *line, time_s: None, position_m: Vector3::zeros(), yaw_rad: None };
    for (column, cell) in columns.iter().zip(cells) {
        let value = finite(cell).ok_or_else(|| WaypointsError::Number { line: *line, found: shortened(cell) })?;
        match column {
            Column::Time => row.time_s = Some(value),
            Column::Axis(axis) => row.position_m[*axis] = value,
            Column::Yaw => row.yaw_rad = Some(value),
            Column::YawDegrees => row.yaw_rad = Some(value.to_radians()),
            Column::Other => {}
        }
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_of_the_wild_read() {
        let timed = parse("t,x,y,z,yaw\n0.0,1.0,0.0,0.5,0.0\n0.5,2,0,0.5,1\n").unwrap();
        assert_eq!((timed[1].time_s, timed[1].position_m.x, timed[1].yaw_rad), (Some(0.5), 2.0, Some(1.0)));
        let bare = parse("0.0,0.45,1.41\n0.0,0.05,1.73\n").unwrap();
        assert_eq!((bare[1].time_s, bare[1].position_m, bare[1].line), (None, Vector3::new(0.0, 0.05, 1.73), 2));
        let german = parse("time [s];x [m];y [m];z [m];yaw_deg\n0;0,5;1;1;90\n").unwrap();
        assert_eq!((german[0].position_m.x, german[0].yaw_rad), (0.5, Some(90_f64.to_radians())));
    }

    #[test]
    fn a_comment_names_the_columns_and_a_quantity_has_one() {
        // `numpy.savetxt(header=...)` writes its header so.
        let row = parse("# t,x,y,z,yaw_deg\n0,0,0,1,0\n3,2,0,1,90\n").unwrap()[1];
        assert_eq!(row.yaw_rad, Some(90_f64.to_radians()));
        let turned = parse("# t,y,x,z\n0,1,2,3\n").unwrap()[0];
        assert_eq!(turned.position_m, Vector3::new(2.0, 1.0, 3.0));
        assert_eq!(parse("time,x,y,z,x\n0,0,0,1,5\n").unwrap_err(), WaypointsError::Twice("x"));
        assert_eq!(parse("t,x,y,z,yaw,yaw_deg\n0,0,0,1,0,0\n").unwrap_err(), WaypointsError::Twice("the yaw"));
    }

    #[test]
    fn recorded_rows_are_not_waypoints() {
        let kind = |text: &str| recognise(&Table::of(text).unwrap());
        assert_eq!(kind("t,x,y,z\n0,0,0,1\n"), Some(Kind::Waypoints { timed: true }));
        assert_eq!(kind("t,x,y,z,vx,vy,vz\n0,0,0,1,0,0,0\n"), Some(Kind::Samples));
        assert_eq!(kind("0,0,0,1,0,0,0\n0.1,0,0,1,0,0,0\n0.2,0,0,1,0,0,0\n"), Some(Kind::Samples));
        assert_eq!(kind("duration,x^0\n1,2\n"), None);
        let refused = parse("t,x,y,z,vx\n0,0,0,1,0\n").unwrap_err().to_string();
        assert!(refused.ends_with("has t,x,y,z,vx"), "{refused}");
    }
}
