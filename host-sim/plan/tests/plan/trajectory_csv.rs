//! The `uav_trajectories` form: real files are read, and rows that cannot be flown are refused by line and column.

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
        format!("{header}\n{a}\n{b}\n").replace(',', ";"),
        format!("{header}\n{a}\n{b}\n").replace(',', "\t"),
        format!("{header}\n{a}\n{b}\n").replace(',', ";").replace('.', ","),
        format!("\"{header}\"\n\"{a}\"\n\"{b}\"\n").replace(',', "\",\""),
        format!(",{header}\n0,{a}\n1,{b}\n"),
        // By name, in any order, yaw and zeros left out.
        "x^0,duration,z^0,y^0\n0.25,1.05,0,0\n0.25,0.5,0,0\n".to_owned(),
    ] {
        assert_eq!(csv::parse(&text).as_ref(), Ok(&pieces), "{text}");
    }
}

#[test]
fn errors_name_line_column_value_and_remedy() {
    let good = row("1", "0");
    assert_eq!(
        error("1,2,3,\n"),
        "line 1: 3 columns; needs 33 (duration, then 8 coefficients each of x, y, z and yaw; write 0 for powers that are not \
         used)"
    );
    assert_eq!(
        csv::parse(&format!("{good},7\n")),
        Err(CsvError::Columns { line: 1, found: 34, decimal_commas: false })
    );
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
    let renamed = error(&header().replace("x^1", "v_x"));
    assert!(
        renamed.starts_with("line 1, column 3: the header has \"v_x\"; columns are duration, then x^0"),
        "{renamed}"
    );
    let twice = error(&header().replace("x^1", "x^2"));
    assert!(twice.starts_with("line 1, column 4: the header has \"x^2\""), "{twice}");
    assert!(error("duration,x^0,y^0\n1,0,0\n").starts_with("line 1: the header has no z^0"));
    let commas = error(&row("1,0", "0,25"));
    assert!(commas.contains("needs 33") && !commas.contains("semicolons"), "{commas}");
    let commas = error(&format!("{}\n{}\n", header(), ["0,5"; 33].join(",")));
    assert!(
        commas.starts_with("line 2: 66 columns") && commas.ends_with("separate the columns by semicolons"),
        "{commas}"
    );
    let ragged = error("duration,x^0,y^0,z^0\n1,0,0\n");
    assert_eq!(ragged, "line 2: 3 columns where the header has 4");
    let jump = error(&format!("{}\n{good}\n# next\n{}\n", header(), row("1", "0.2")));
    assert!(jump.starts_with("line 4: x jumps by 0.200000 m from the end of piece 1"), "{jump}");
}

#[test]
fn a_higher_degree_than_is_flown_is_named() {
    let names = |highest: usize| -> Vec<String> {
        ["x", "y", "z", "yaw"].iter().flat_map(|c| (0..=highest).map(move |power| format!("{c}^{power}"))).collect()
    };
    let file = |last: &str| {
        let mut cells = vec!["0"; 40];
        cells[9] = last;
        format!("duration,{}\n2.0,{}\n", names(9).join(","), cells.join(","))
    };
    let used = error(&file("0.1"));
    assert!(used.starts_with("line 1: polynomials of degree 9; at most degree 7 is flown"), "{used}");
    assert!(used.ends_with("fit the pieces anew with 8 coefficients each"), "{used}");
    assert!(error(&file("0")).ends_with("all coefficients above x^7 are 0 here, so leave those columns out"));
    // Without a header, by the number of columns.
    let bare = file("0.1").lines().nth(1).unwrap().to_owned();
    assert!(error(&bare).contains("at most degree 7"), "{}", error(&bare));
    // A lower degree is read.
    let low = format!("duration,{}\n1,{}\n", names(3).join(","), ["0.5"; 16].join(","));
    assert_eq!(csv::parse(&low).unwrap().at(1.0).position_m.x, 2.0);
}

#[test]
fn gaps_of_rounding_are_closed_and_others_named_with_their_line() {
    // Two pieces of 4 s cut to six places: at the end of the first, 0.5e-6 * (4^8 - 1) / 3 = 11 mm can be missing.
    let coefficients = [0.123456, -0.234567, 0.345678, -0.078901, 0.012345, -0.001234, 0.000123, -0.000012];
    let mut exact = Piece { duration_s: 4.0, coefficients: [[0.0; 8]; 4] };
    exact.coefficients[0] = coefficients;
    let end_m = exact.derivative(Coordinate::X, 0, 4.0);
    let file = |gap_m: f64| {
        let cells: Vec<String> = coefficients.iter().map(|c| format!("{c:.6}")).collect();
        let zeros = ["0.000000"; 24].join(",");
        let rest = format!("4.000000,{:.6}{}", end_m + gap_m, ",0.000000".repeat(31));
        format!("{}\n4.000000,{},{zeros}\n{rest}\n", header(), cells.join(","))
    };
    for gap_m in [0.0, 0.0005, 0.002, -0.009] {
        let pieces = csv::parse(&file(gap_m)).unwrap_or_else(|error| panic!("{gap_m}: {error}"));
        let [before, after] = [&pieces.pieces()[0], &pieces.pieces()[1]];
        let left_m = (before.derivative(Coordinate::X, 0, 4.0) - after.coefficients[0][0]).abs();
        // A gap that the board flies as it is stays.
        assert!(left_m < 0.995e-3, "{gap_m}: {left_m}");
        let kept = (1..4).all(|order| {
            (before.derivative(Coordinate::X, order, 4.0) - exact.derivative(Coordinate::X, order, 4.0)).abs() < 1e-9
        });
        assert!(kept, "{gap_m}: its derivatives at the joint");
    }
    let far = error(&file(0.02));
    assert!(far.starts_with("line 3: x jumps by 0.02"), "{far}");
    // The same gap over 1 s is no rounding.
    let short = error(&format!("{}\n{}\n{}\n", header(), row("1.000000", "0.000000"), row("1.000000", "0.002000")));
    assert!(short.starts_with("line 3: x jumps by 0.002000 m from the end of piece 1"), "{short}");
    // A gap that numbers of few digits leave is the board's to refuse: 1 mm, with any last bit of the difference.
    assert!(error(&format!("{}\n{}\n", row("2.0", "1.0"), row("2.0", "1.001"))).contains("piece 2"));
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
    fn written_pieces_read_back_equal(pieces in continuous_pieces()) {
        prop_assert_eq!(csv::parse(&csv::write(&pieces)), Ok(pieces));
    }

    #[test]
    fn no_text_breaks_the_reader(text in any::<String>()) {
        // Any result will do, that there is one is the property; an error stays one line.
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
