//! Tables of results, to be read by people and cut by scripts.

use comfy_table::{CellAlignment, Table, presets};

/// A table: a header, then rows; all but the first columns `left` are aligned to the right.
pub fn table(header: &[&str], left: usize, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_HORIZONTAL_ONLY).set_header(header);
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(left) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.to_string()
}

/// A number with four significant digits, so that columns hold dim and bright alike.
pub fn number(v: f64) -> String {
    let digits = if v == 0.0 || !v.is_finite() { 3 } else { 3 - v.abs().log10().floor() as i32 };
    format!("{v:.*}", digits.clamp(0, 9) as usize)
}
