//! Tables of the paper's gains, and of those past it, as files for a vehicle of the tests.

use quatrack::gains::paper;
use quatrack::gains::table::{
    Certificate, GainTable, Hash, Margins, Name, Rows, ScheduleRows, TABLE_BYTES_MAX, TableHead, TableKind, Vehicle,
};
use quatrack::nalgebra::Vector3;
use quatrack::{Limits, Rate};

pub(crate) const VEHICLE: Vehicle = Vehicle { name: Name::literal("crazyflie-2.1"), id: 0x0102_0304 };

pub(crate) fn rate() -> Rate {
    Rate::from_hz(500).unwrap()
}

/// The figures only have to be possible ones: no test here is about their truth.
pub(crate) fn head(name: &str) -> TableHead {
    TableHead {
        name: Name::new(name).unwrap(),
        vehicle: VEHICLE,
        rate: rate(),
        limits: Limits::new(1.75, 16.5, Vector3::new(20.0, 20.0, 5.0)).unwrap(),
        design_hash: Hash([0xD5; 32]),
        certificate: Certificate {
            hash: Hash([0xCE; 32]),
            one_channel: Margins { gain_factor: 3.0, phase_rad: 1.0 },
            all_channels: Margins { gain_factor: 2.0, phase_rad: 0.75 },
            delay_max_s: 0.0625,
            motor_lag_max_s: 0.03125,
            f32_distance: 2.5e-8,
        },
    }
}

/// The four tables of the paper, by name.
pub(crate) fn paper_tables() -> [(&'static str, Rows); 4] {
    [
        ("lyap-e", Rows::Equilibrium(*paper::LYAP_E.gain().rows())),
        ("lqr-e", Rows::Equilibrium(*paper::LQR_E.gain().rows())),
        ("lyap-f", Rows::FlatOutput(*paper::LYAP_F.gain().rows())),
        ("lqr-f", Rows::FlatOutput(*paper::LQR_F.gain().rows())),
    ]
}

/// LQR-E with gains of its position integrals; 50.9 and 20.7 are those of the design with weights 50.
pub(crate) fn integral_rows() -> [[f32; 12]; 4] {
    let answers = [[0.0, 0.0, 50.9], [0.0, -20.7, 0.0], [20.7, 0.0, 0.0], [0.0; 3]];
    let mut rows = [[0.0; 12]; 4];
    for ((row, gains), answers) in rows.iter_mut().zip(paper::LQR_E.gain().rows()).zip(answers) {
        row[..9].copy_from_slice(gains);
        row[9..].copy_from_slice(&answers);
    }
    rows
}

/// All tables of one gain, by name.
pub(crate) fn tables() -> Vec<(&'static str, Rows)> {
    paper_tables().into_iter().chain([("lqi-e", Rows::Integral(integral_rows()))]).collect()
}

pub(crate) fn table(name: &str) -> GainTable<'static> {
    let (_, rows) = tables().into_iter().find(|(known, _)| *known == name).unwrap();
    GainTable::new(head(name), &rows).unwrap()
}

pub(crate) fn bytes_of(table: &GainTable<'_>) -> Vec<u8> {
    table.to_bytes(&mut [0; TABLE_BYTES_MAX]).unwrap().to_vec()
}

/// With the checksum that belongs to the bytes before it: damage that no checksum finds.
pub(crate) fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let checksum = quatrack::link::crc32c(&bytes[..end]);
    bytes[end..].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

pub(crate) fn dimensions(kind: TableKind) -> (usize, usize) {
    let (rows, columns) = kind.dimensions();
    (usize::from(rows), usize::from(columns))
}

/// The checksum of no trajectory in particular.
pub(crate) const TRAJECTORY: u32 = 0x1122_3344;

/// LQR-E, a little stiffer from knot to knot and with an entry that the stationary one does not have.
pub(crate) fn gains_over_time(knots: usize) -> Vec<[[f32; 9]; 4]> {
    let gain = paper::LQR_E.gain();
    (0..knots)
        .map(|knot| {
            let share = knot as f32 / 64.0;
            let mut rows = gain.rows().map(|row| row.map(|entry| entry * (1.0 + share)));
            rows[0][0] = share;
            rows
        })
        .collect()
}

pub(crate) fn schedule_bytes(gains: &[[[f32; 9]; 4]]) -> Vec<u8> {
    let rows = ScheduleRows { trajectory: TRAJECTORY, steps_per_knot: 25, gains };
    bytes_of(&GainTable::along(&mut [0; TABLE_BYTES_MAX], &head("along"), &rows).unwrap())
}
