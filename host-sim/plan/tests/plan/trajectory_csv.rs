//! The `uav_trajectories` form: what real files hold is read, what cannot be flown is refused by line and column.

use std::path::Path;

use proptest::prelude::*;
use quatrack_plan::trajectory::Trajectory;
use quatrack_plan::trajectory::polynomial::csv::{self, CsvError};
use quatrack_plan::trajectory::polynomial::{Coordinate, Piece, PiecewisePolynomial};

/// A row that stays at x = `from`.
fn row(duration: &str, from: &str) -> String {
    format!("{duration},{from},{}", ["0"; 31].join(","))
}

/// The header as written.
fn header() -> String {
    let pieces = csv::parse(&row("1", "0")).expect("a good row");
    csv::write(&pieces).lines().next().expect("a header").to_owned()
}

fn error(text: &str) -> String {
    csv::parse(text).expect_err("must be refused").to_string()
}

#[test]
fn forms_found_in_the_wild_read_alike() {
    let pieces = csv::parse(&format!("{}\n{}\n", row("1.05", "0.25"), row("0.5", "0.25"))).expect("no header at all");
    assert_eq!(pieces.duration_s(), 1.05 + 0.5);
    assert_eq!(pieces.at(1.2).position_m.x, 0.25);
    let (header, a, b) = (header(), row("1.05", "0.25"), row(" 0.500000 ", "2.5e-1"));
    assert!(header.starts_with("duration,x^0,x^1,") && header.ends_with(",yaw^7"), "{header}");
    for text in [
        format!("{header},\r\n{a},\r\n{b},\r\n"),
        format!("# made by a tool\n# {header}\n\n{a}\n\n# second\n{b}"),
        format!("\u{feff}{}\n{a} , \n,,,\n{b},,\n", header.replace("duration", "Duration")),
    ] {
        assert!(csv::recognises(&text), "{text}");
        assert_eq!(csv::parse(&text).as_ref(), Ok(&pieces), "{text}");
    }
}

#[test]
fn errors_name_line_column_value_and_remedy() {
    let good = row("1", "0");
    assert_eq!(
        error("1,2,3,\n"),
        "line 1: 3 columns; needs 33 (duration, then 8 coefficients each of x, y, z and yaw; write 0 for what is not \
         used)"
    );
    assert_eq!(csv::parse(&format!("{good},7\n")), Err(CsvError::Columns { line: 1, found: 34 }));
    assert_eq!(
        error(&format!("# c\n\n{good}\n{}\n", row("1", "O.5"))),
        "line 4, x^0: \"O.5\" is not a finite number; write one such as 0.25"
    );
    for cell in ["nan", "inf", "1e999", ""] {
        let expected = format!("line 1, duration: {cell:?} is not a finite number; write one such as 0.25");
        assert_eq!(error(&row(cell, "0")), expected);
    }
    for cell in ["0", "-0.5"] {
        let expected = format!("line 2, duration: {cell} s; must be positive: remove the row or correct it");
        assert_eq!(error(&format!("{good}\n{}", row(cell, "0"))), expected);
    }
    for text in ["", "\n# nothing\n", "\u{feff}", &header()] {
        assert_eq!(csv::parse(text), Err(CsvError::Empty), "{text}");
    }
    assert_eq!(
        error(&header().replace("x^0,x^1", "x^1,x^0")),
        "line 1, column 2: the header has \"x^1\" where this format has \"x^0\"; reorder the columns"
    );
    let jump = error(&format!("{}\n{good}\n# next\n{}\n", header(), row("1", "0.2")));
    assert!(jump.starts_with("line 4: x jumps by 0.200000 m from the end of piece 1"), "{jump}");
}

#[test]
fn a_wrong_cell_is_quoted_in_one_short_line() {
    let text = error(&row("1", &"x".repeat(10_000)));
    assert!(text.len() < 200 && !text.contains('\n'), "{text}");
}

#[test]
fn the_public_figure_of_eight_reads() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/paper/trajectories/figure8.csv");
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: the public figure8.csv is not on this machine");
        return;
    };
    let pieces = csv::parse(&text).expect("a real file");
    assert_eq!(pieces.pieces().len(), 10);
    // The file has 6 decimals; nine sums of numbers below 8 round by 1e-15 each.
    assert!((pieces.duration_s() - 7.283185).abs() < 1e-13);
    let steepest = (0..=72_831)
        .map(|k| pieces.at(f64::from(k) * 1e-4).acceleration_m_s2)
        .map(|a| a.xy().norm().atan2(a.z + 9.81).to_degrees())
        .fold(0.0, f64::max);
    // Known as 17.35 degrees, that is, to half a hundredth.
    assert!((steepest - 17.35).abs() <= 0.005, "{steepest}");
}

fn continuous_pieces() -> impl Strategy<Value = PiecewisePolynomial> {
    let piece = (0.01..3.0_f64, prop::array::uniform4(prop::array::uniform8(-2.0..2.0_f64)));
    prop::collection::vec(piece, 1..6).prop_map(|pieces| {
        let mut joined: Vec<Piece> = Vec::new();
        for (duration_s, mut coefficients) in pieces {
            if let Some(last) = joined.last() {
                for coordinate in Coordinate::ALL {
                    coefficients[coordinate as usize][0] = last.derivative(coordinate, 0, last.duration_s);
                }
            }
            joined.push(Piece { duration_s, coefficients });
        }
        PiecewisePolynomial::new(joined).expect("joined without gaps")
    })
}

proptest! {
    #[test]
    fn what_is_written_reads_back_equal(pieces in continuous_pieces()) {
        prop_assert_eq!(csv::parse(&csv::write(&pieces)), Ok(pieces));
    }

    #[test]
    fn no_text_breaks_the_reader(text in any::<String>()) {
        // What comes out is free, that it comes out is the property; an error stays one line.
        if let Err(error) = csv::parse(&text) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }

    #[test]
    fn no_damage_to_a_file_breaks_the_reader(
        pieces in continuous_pieces(),
        at in any::<prop::sample::Index>(),
        insert in "[-0-9.,\n#e^a-z\r\u{fe}]{0,4}",
    ) {
        let mut text = csv::write(&pieces);
        let at = at.index(text.len());
        text.replace_range(at..=at, &insert);
        if let Ok(read) = csv::parse(&text) {
            prop_assert!(read.duration_s() > 0.0 && read.duration_s().is_finite());
            prop_assert!(read.at(0.0).position_m.iter().all(|v| v.is_finite()));
        }
    }
}
