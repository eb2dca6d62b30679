//! CSV files, a row at a time.

use std::fmt::Display;
use std::fs;
use std::path::Path;

/// A table under construction.
#[derive(Debug, Clone, Default)]
pub struct Table {
    columns: usize,
    text: String,
}

impl Table {
    /// An empty table with these column names.
    pub fn new(columns: &[&str]) -> Self {
        let mut table = Self {
            columns: columns.len(),
            text: String::new(),
        };
        table.row(columns.iter().map(ToString::to_string).collect());
        table
    }

    /// Appends a row; no cell may hold a comma or a quote.
    ///
    /// # Panics
    /// If the number of cells differs from that of the columns.
    pub fn row(&mut self, cells: Vec<String>) {
        assert_eq!(cells.len(), self.columns, "{cells:?}");
        self.text += &cells.join(",");
        self.text.push('\n');
    }

    /// Writes the table.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn write(&self, folder: &Path, name: &str) {
        let path = folder.join(name);
        fs::create_dir_all(folder).expect("the folder can be made");
        fs::write(&path, &self.text).expect("the table can be written");
    }
}

/// The text of a number for a cell: the shorter of all digits and six significant ones; empty if it is missing or not finite.
pub fn number(value: impl Into<Option<f64>>) -> String {
    value
        .into()
        .filter(|value| value.is_finite())
        .map_or_else(String::new, |value| {
            let plain = format!("{value}");
            let short = format!("{value:.5e}");
            if plain.len() <= short.len() {
                plain
            } else {
                short
            }
        })
}

/// Anything printable for a cell.
pub fn text(value: impl Display) -> String {
    value.to_string()
}

/// First quartile, median and third quartile.
pub fn quartiles(values: &[f64]) -> [f64; 3] {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|fraction| {
        let Some(last) = sorted.len().checked_sub(1) else {
            return f64::NAN;
        };
        let index = fraction * last as f64;
        let (low, high) = (index.floor() as usize, index.ceil() as usize);
        sorted[low] + (sorted[high] - sorted[low]) * index.fract()
    })
}

/// The median.
pub fn median(values: &[f64]) -> f64 {
    quartiles(values)[1]
}
