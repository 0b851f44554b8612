//! Rows as Parquet: read by DuckDB, pandas and polars as they are. A group of rows at a time is in memory.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::partial::Partial;
use crate::error::CampaignError;
use crate::row::{FIXED, Row};

/// Rows in memory at a time.
const GROUP: usize = 16_384;

/// Writes rows under a temporary name and renames the file.
pub(super) fn write(
    path: &Path,
    drawn: &[String],
    rows: impl Iterator<Item = Result<Row, CampaignError>>,
) -> Result<(), CampaignError> {
    let refused = |error: &dyn std::fmt::Display| CampaignError::file(path, "cannot be written", error);
    let (partial, file) = Partial::beside(path)?;
    let schema = schema(drawn).map_err(|error| refused(&error))?;
    let properties = Arc::new(WriterProperties::builder().set_created_by("quatrack".to_owned()).build());
    let mut writer = SerializedFileWriter::new(file, schema, properties).map_err(|error| refused(&error))?;
    let mut group = Vec::with_capacity(GROUP);
    for row in rows {
        group.push(row?);
        if group.len() == GROUP {
            write_group(&mut writer, &group).map_err(|error| refused(&error))?;
            group.clear();
        }
    }
    if !group.is_empty() {
        write_group(&mut writer, &group).map_err(|error| refused(&error))?;
    }
    writer.close().map_err(|error| refused(&error))?;
    partial.rename(path).map_err(|error| refused(&error))
}

fn schema(drawn: &[String]) -> Result<Arc<Type>, ParquetError> {
    let column = |name: &str, physical, repetition, logical| {
        Type::primitive_type_builder(name, physical).with_repetition(repetition).with_logical_type(logical).build()
    };
    let (needed, absent) = (Repetition::REQUIRED, Repetition::OPTIONAL);
    let kinds = [
        (Physical::INT64, needed, None),
        (Physical::BYTE_ARRAY, needed, Some(LogicalType::String)),
        (Physical::INT64, needed, None),
        (Physical::BYTE_ARRAY, needed, Some(LogicalType::String)),
        (Physical::DOUBLE, absent, None),
        (Physical::DOUBLE, absent, None),
        (Physical::INT64, absent, None),
        (Physical::DOUBLE, absent, None),
        (Physical::BYTE_ARRAY, needed, Some(LogicalType::String)),
    ];
    let mut fields = Vec::new();
    for (name, (physical, repetition, logical)) in FIXED.iter().zip(kinds) {
        fields.push(Arc::new(column(name, physical, repetition, logical)?));
    }
    for name in drawn {
        fields.push(Arc::new(column(name, Physical::DOUBLE, needed, None)?));
    }
    Type::group_type_builder("rows").with_fields(fields).build().map(Arc::new)
}

fn write_group(writer: &mut SerializedFileWriter<File>, rows: &[Row]) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    let text = |of: &dyn Fn(&Row) -> &str| rows.iter().map(|row| ByteArray::from(of(row))).collect::<Vec<_>>();
    let numbers = |of: &dyn Fn(&Row) -> Option<f64>| rows.iter().map(of).collect::<Vec<_>>();
    whole(&mut group, &rows.iter().map(|row| Some(row.run)).collect::<Vec<_>>(), false)?;
    texts(&mut group, &text(&|row| row.law.name()))?;
    whole(&mut group, &rows.iter().map(|row| Some(row.seed)).collect::<Vec<_>>(), false)?;
    texts(&mut group, &text(&|row| row.outcome.name()))?;
    doubles(&mut group, &numbers(&|row| row.iae_m_s), true)?;
    doubles(&mut group, &numbers(&|row| row.max_error_m), true)?;
    whole(&mut group, &rows.iter().map(|row| row.saturated_steps).collect::<Vec<_>>(), true)?;
    doubles(&mut group, &numbers(&|row| row.lost_s), true)?;
    texts(&mut group, &text(&|row| &row.reason))?;
    for index in 0..rows.first().map_or(0, |row| row.drawn.len()) {
        doubles(&mut group, &numbers(&|row| Some(row.drawn[index])), false)?;
    }
    group.close().map(|_| ())
}

type Group<'a> = SerializedRowGroupWriter<'a, File>;

/// Which of them are there, where some may be absent.
fn levels<T>(values: &[Option<T>], optional: bool) -> Option<Vec<i16>> {
    optional.then(|| values.iter().map(|value| i16::from(value.is_some())).collect())
}

fn doubles(group: &mut Group<'_>, values: &[Option<f64>], optional: bool) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    let there: Vec<f64> = values.iter().flatten().copied().collect();
    column.typed::<DoubleType>().write_batch(&there, levels(values, optional).as_deref(), None)?;
    column.close()
}

fn whole(group: &mut Group<'_>, values: &[Option<u64>], optional: bool) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    // At most 53 bits each.
    let there: Vec<i64> = values.iter().flatten().map(|value| *value as i64).collect();
    column.typed::<Int64Type>().write_batch(&there, levels(values, optional).as_deref(), None)?;
    column.close()
}

fn texts(group: &mut Group<'_>, values: &[ByteArray]) -> Result<(), ParquetError> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<ByteArrayType>().write_batch(values, None, None)?;
    column.close()
}
