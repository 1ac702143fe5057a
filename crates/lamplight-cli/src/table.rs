//! Tables of results, for people and scripts.

use comfy_table::{CellAlignment, LineStyle, Table, TableStyle};

/// A single line, under the header.
const STYLE: TableStyle =
    TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// A table with a header. The columns `words` are aligned to the left, the others, of numbers, to the
/// right.
pub fn table(
    header: &[&str],
    words: &[usize],
    rows: impl IntoIterator<Item = Vec<String>>,
) -> String {
    let mut table = Table::new();
    table.load_style(STYLE).set_header(header.iter().copied());
    table.add_rows(rows);
    let numbers = table.column_iter_mut().enumerate().filter(|(i, _)| !words.contains(i));
    for (_, column) in numbers {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// A number with four significant digits.
pub fn number(v: f64) -> String {
    let digits = if v == 0.0 || !v.is_finite() { 3 } else { 3 - v.abs().log10().floor() as i32 };
    format!("{v:.*}", digits.clamp(0, 9) as usize)
}
