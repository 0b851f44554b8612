//! Trajectories as the board stores and plays them, against the f64 curves they come from.

use quatrack::nalgebra::Vector3;
use quatrack::trajectory::{MAX_DURATION_NS, TrajectoryError};
use quatrack::{FlatSample, Piece, Player, Rate, Trajectory};
use quatrack_plan::plan;
use quatrack_plan::trajectory::Trajectory as _;
use quatrack_plan::trajectory::on_board;
use quatrack_plan::trajectory::polynomial::PiecewisePolynomial;

fn paper_trajectories() -> [PiecewisePolynomial; 2] {
    [plan::paper::mild(), plan::paper::aggressive()]
        .map(|plan| PiecewisePolynomial::from_bspline(&plan.unwrap().solve().unwrap()).unwrap())
}

fn constant(duration_ns: u64, x: f32) -> Piece {
    let at = |value: f32| [value, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    Piece { duration_ns, x: at(x), y: at(0.0), z: at(0.0), heading: at(0.0) }
}

#[test]
fn the_player_follows_the_papers_trajectories_at_any_rate() {
    for trajectory in paper_trajectories() {
        let pieces = on_board::pieces(&trajectory);
        for hz in [100, 333, 500, 1000] {
            let mut player = Player::new(Trajectory::new(&pieces).unwrap(), Rate::from_hz(hz).unwrap());
            for tick in 0..player.end_tick() {
                let found = player.at(tick);
                let exact = trajectory.at(f64::from(tick) / f64::from(hz));
                let error = |found: Vector3<f32>, exact: Vector3<f64>| (found.map(f64::from) - exact).amax();
                // Coefficients and Horner's sums are rounded to 6e-8 of terms up to the size of a piece's own largest.
                assert!(error(found.position_m, exact.position_m) < 5e-7, "position at tick {tick} of {hz} Hz");
                assert!(error(found.velocity_m_s, exact.velocity_m_s) < 5e-6);
                assert!(error(found.acceleration_m_s2, exact.acceleration_m_s2) < 5e-5);
                assert!(error(found.jerk_m_s3, exact.jerk_m_s3) < 1e-3);
            }
            let end = player.at(player.end_tick());
            assert_eq!(end, FlatSample::at_rest(end.position_m, end.heading_rad), "rest after the end");
        }
    }
}

#[test]
fn ticks_may_jump_and_run_backwards() {
    let [_, trajectory] = paper_trajectories();
    let pieces = on_board::pieces(&trajectory);
    let new = || Player::new(Trajectory::new(&pieces).unwrap(), Rate::from_hz(500).unwrap());
    let mut forwards = new();
    let in_order: Vec<FlatSample> = (0..6000).map(|tick| forwards.at(tick)).collect();
    let mut jumping = new();
    for k in 0..6000_u32 {
        let tick = (k * 2_503) % 6000;
        assert_eq!(jumping.at(tick), in_order[tick as usize], "tick {tick}");
    }
    // The W ends where it began.
    assert!(new().at(u32::MAX).position_m.amax() < 1e-6);
}

#[test]
fn a_bookmark_goes_on_where_the_player_was() {
    let [mild, w] = paper_trajectories();
    let (pieces, others) = (on_board::pieces(&w), on_board::pieces(&mild));
    let trajectory = Trajectory::new(&pieces).unwrap();
    let mut whole = Player::new(trajectory, Rate::from_hz(500).unwrap());
    let mut bookmark = whole.bookmark();
    for tick in (0..6500).chain([100, 4000]) {
        let mut resumed = Player::resume(trajectory, bookmark).unwrap();
        assert_eq!(resumed.at(tick), whole.at(tick), "tick {tick}");
        bookmark = resumed.bookmark();
    }
    assert!(Player::resume(Trajectory::new(&others).unwrap(), bookmark).is_none());
}

#[test]
fn derivatives_are_those_of_the_monomials() {
    // x = t^7, y = 1 - t, z = 2 t^3, heading = t^2 / 4 at t = 1/2, all exact in binary.
    let piece = Piece {
        duration_ns: 1_000_000_000,
        x: [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        y: [1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        z: [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0],
        heading: [0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0],
    };
    let pieces = [piece];
    let sample = Player::new(Trajectory::new(&pieces).unwrap(), Rate::from_hz(2).unwrap()).at(1);
    assert_eq!(sample.position_m, Vector3::new(1.0 / 128.0, 0.5, 0.25));
    assert_eq!(sample.velocity_m_s, Vector3::new(7.0 / 64.0, -1.0, 1.5));
    assert_eq!(sample.acceleration_m_s2, Vector3::new(42.0 / 32.0, 0.0, 6.0));
    assert_eq!(sample.jerk_m_s3, Vector3::new(210.0 / 16.0, 0.0, 12.0));
    assert_eq!((sample.heading_rad, sample.heading_rate_rad_s), (0.0625, 0.25));
}

#[test]
fn pieces_that_cannot_be_flown_are_refused_by_number() {
    let second = 1_000_000_000;
    assert_eq!(Trajectory::new(&[]), Err(TrajectoryError::Empty));
    let refused = |pieces: &[Piece]| Trajectory::new(pieces).unwrap_err();
    assert_eq!(refused(&[constant(second, 0.0), constant(0, 0.0)]), TrajectoryError::NoDuration { piece: 1 });
    assert_eq!(refused(&[constant(second, f32::NAN)]), TrajectoryError::NonFinite { piece: 0 });
    // t^7 leaves the range of f32 within the piece: 3e38 * (3600 s)^7.
    let mut steep = constant(MAX_DURATION_NS, 0.0);
    steep.x[7] = f32::MAX;
    assert_eq!(refused(&[steep]), TrajectoryError::NonFinite { piece: 0 });
    let jump = refused(&[constant(second, 0.0), constant(second, 0.0), constant(second, 0.25)]);
    assert_eq!(jump, TrajectoryError::Jump { piece: 2, size: 0.25 });
    let long = refused(&[constant(MAX_DURATION_NS, 0.0), constant(1, 0.0)]);
    assert_eq!(long, TrajectoryError::TooLong { piece: 1 });
    assert_eq!(refused(&[constant(u64::MAX, 0.0)]), TrajectoryError::TooLong { piece: 0 });
}

#[test]
fn a_checksum_tells_trajectories_apart() {
    let [mild, aggressive] = paper_trajectories().map(|trajectory| on_board::pieces(&trajectory));
    let checksum = |pieces: &[Piece]| Trajectory::new(pieces).unwrap().checksum();
    // Byte by byte as documented, with the checksum of the frames of the link.
    let bytes: Vec<u8> = mild
        .iter()
        .flat_map(|piece| {
            let coefficients = [piece.x, piece.y, piece.z, piece.heading].concat();
            let coefficients = coefficients.into_iter().flat_map(f32::to_le_bytes);
            piece.duration_ns.to_le_bytes().into_iter().chain(coefficients).collect::<Vec<u8>>()
        })
        .collect();
    assert_eq!(checksum(&mild), quatrack::checksum::crc32c(&bytes));
    assert_ne!(checksum(&mild), checksum(&aggressive));
    let mut later = mild.clone();
    later[3].duration_ns += 1;
    assert_ne!(checksum(&mild), checksum(&later));
    let mut moved = mild.clone();
    moved[7].y[0] = moved[7].y[0].next_up();
    assert_ne!(checksum(&mild), checksum(&moved));
}
