//! Trajectories in the board's flash: planned pieces in; Rust source for the image out, and the stored pieces themselves.

use std::fmt::Write as _;

use quatrack::Piece;

use super::paper::PaperTrajectory;

/// The same files that the image is built from.
#[allow(unreachable_pub, reason = "the image needs them public")]
mod image {
    use quatrack::Piece;

    include!("../../plans/mild.rs");
    include!("../../plans/aggressive.rs");
}

/// The pieces of a trajectory of the paper as they are stored in the board's flash.
pub fn pieces(course: PaperTrajectory) -> &'static [Piece] {
    match course {
        PaperTrajectory::Mild => &image::MILD,
        PaperTrajectory::Aggressive => &image::AGGRESSIVE,
    }
}

/// Pieces as a Rust constant; every number reads back to the same bits.
pub fn rust_source(name: &str, pieces: &[Piece]) -> String {
    let mut text =
        format!("/// Written by `quatrack plan --rust`.\npub static {name}: [Piece; {}] = [\n", pieces.len());
    for piece in pieces {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "    Piece {{\n        duration_ns: {},", piece.duration_ns);
        for (coordinate, coefficients) in
            [("x", &piece.x), ("y", &piece.y), ("z", &piece.z), ("heading", &piece.heading)]
        {
            let _ = writeln!(text, "        {coordinate}: {coefficients:?},");
        }
        text.push_str("    },\n");
    }
    text.push_str("];\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Plan, paper};
    use crate::trajectory::on_board;
    use crate::trajectory::polynomial::PiecewisePolynomial;

    /// A solver's last digits differ between machines, and with them those of the coefficients.
    const TOLERANCE: f32 = 1e-6;

    fn assert_regenerates(stored: &[Piece], plan: &Plan) {
        let planned = on_board::pieces(&PiecewisePolynomial::from_bspline(&plan.solve().unwrap()).unwrap());
        assert_eq!(stored.len(), planned.len(), "another number of pieces than the plan has: store it again");
        for (index, (stored, planned)) in stored.iter().zip(&planned).enumerate() {
            assert_eq!(stored.duration_ns, planned.duration_ns, "piece {index}");
            let axes = [
                (stored.x, planned.x),
                (stored.y, planned.y),
                (stored.z, planned.z),
                (stored.heading, planned.heading),
            ];
            for (stored, planned) in axes.iter().flat_map(|(stored, planned)| stored.iter().zip(planned)) {
                let error = (stored - planned).abs() / planned.abs().max(1.0);
                assert!(error <= TOLERANCE, "piece {index}: stored {stored}, planned {planned}: store it again");
            }
        }
    }

    #[test]
    fn the_stored_pieces_are_the_planned_ones() {
        assert_regenerates(pieces(PaperTrajectory::Mild), &paper::mild().unwrap());
        assert_regenerates(pieces(PaperTrajectory::Aggressive), &paper::aggressive().unwrap());
    }

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        let piece = Piece {
            duration_ns: 7,
            x: [0.1, -1.5e-30, 1e20, 0.0, -0.0, 3.0, 1.0 / 3.0, 2.0],
            ..pieces(PaperTrajectory::Mild)[0]
        };
        let text = rust_source("ONE", &[piece]);
        assert!(text.contains("x: [0.1, -1.5e-30, 1e20, 0.0, -0.0, 3.0, 0.33333334, 2.0],"), "{text}");
        assert_eq!("0.33333334".parse::<f32>().unwrap().to_bits(), (1.0_f32 / 3.0).to_bits());
    }
}
