//! Measures of the error of light.

use lamplight::Rgb;

/// Errors over the open cells and the three channels, each ÷ the mean of the reference over the same.
///
/// If the reference is black, its mean is 0, and a measure is 0 if its error is 0, else infinite (bias:
/// with its sign). Without an open cell every measure is 0. Light that holds NaN has NaN errors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// The root of the mean squared error.
    pub relative_rmse: f64,
    /// The mean error; above 0 is too bright.
    pub bias: f64,
    /// The median of the absolute error (the upper one of two).
    pub median: f64,
    /// The 99th percentile of the absolute error: 99 of 100 values are at most this.
    pub p99: f64,
    /// The mean of the reference, the unit of the others.
    pub mean: f64,
}

impl Measures {
    /// Compares light with the reference. Cells in which `solid` is set are ignored.
    ///
    /// # Panics
    /// If the three differ in length.
    pub fn of(light: &[Rgb], truth: &[Rgb], solid: &[bool]) -> Self {
        assert!(light.len() == truth.len() && truth.len() == solid.len(), "sizes differ");
        let open =
            || (0..solid.len()).filter(|&i| !solid[i]).flat_map(|i| (0..3).map(move |c| (i, c)));
        let mut errors: Vec<f64> =
            open().map(|(i, c)| f64::from(light[i][c]) - f64::from(truth[i][c])).collect();
        if errors.is_empty() {
            return Self::default();
        }
        let n = errors.len() as f64;
        let mean = open().map(|(i, c)| f64::from(truth[i][c])).sum::<f64>() / n;
        let rmse = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
        let bias = errors.iter().sum::<f64>() / n;
        errors.iter_mut().for_each(|e| *e = e.abs());
        // NaN sorts last: it must not hide in a percentile.
        let (median, p99) = if rmse.is_nan() {
            (f64::NAN, f64::NAN)
        } else {
            (percentile(&mut errors, 0.5), percentile(&mut errors, 0.99))
        };
        let relative = |e: f64| if e == 0.0 { 0.0 } else { e / mean };
        Self {
            relative_rmse: relative(rmse),
            bias: relative(bias),
            median: relative(median),
            p99: relative(p99),
            mean,
        }
    }
}

/// The least value that at least this fraction of the values does not exceed (and more than it, for
/// fractions that fall between two values).
fn percentile(values: &mut [f64], fraction: f64) -> f64 {
    let rank = ((values.len() as f64 * fraction) as usize).min(values.len() - 1);
    *values.select_nth_unstable_by(rank, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums of a few f32 in f64.
    const ROUNDING: f64 = 1e-6;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < ROUNDING
    }

    #[test]
    fn figures_worked_out_by_hand() {
        // Truth: mean 2 over two open cells. Errors: +1, 0, 0 and −0.5, 0, 0; the solid cell's
        // error of 100 does not count.
        let truth = [[2.0; 3], [2.0; 3], [0.0; 3]];
        let light = [[3.0, 2.0, 2.0], [1.5, 2.0, 2.0], [100.0; 3]];
        let m = Measures::of(&light, &truth, &[false, false, true]);
        assert!(close(m.mean, 2.0));
        assert!(close(m.relative_rmse, (1.25f64 / 6.0).sqrt() / 2.0), "{m:?}");
        assert!(close(m.bias, 0.5 / 6.0 / 2.0), "{m:?}");
        assert!(close(m.median, 0.0), "{m:?}");
        assert!(close(m.p99, 0.5), "{m:?}");
    }

    #[test]
    fn percentiles_of_a_ramp() {
        let mut ramp: Vec<f64> = (1..=1000).rev().map(f64::from).collect();
        assert_eq!(percentile(&mut ramp, 0.5), 501.0);
        assert_eq!(percentile(&mut ramp, 0.99), 991.0);
    }

    #[test]
    fn the_same_light_has_no_error_and_a_perturbed_one_has() {
        let truth: Vec<Rgb> = (0..100).map(|i| [i as f32, 1.0, 0.5]).collect();
        let solid = vec![false; 100];
        let same = Measures::of(&truth, &truth, &solid);
        assert_eq!((same.relative_rmse, same.bias, same.median, same.p99), (0.0, 0.0, 0.0, 0.0));
        let mut light = truth.clone();
        light[17][2] += 0.25;
        let m = Measures::of(&light, &truth, &solid);
        assert!(m.relative_rmse > 0.0 && m.bias > 0.0);
        light.iter_mut().for_each(|rgb| rgb[0] *= 1.01);
        let m = Measures::of(&light, &truth, &solid);
        assert!(m.p99 > 0.0 && m.median == 0.0, "two of three channels are as they were: {m:?}");
    }

    #[test]
    fn a_black_truth_is_matched_or_missed_by_infinity() {
        let black = [[0.0; 3]; 4];
        let m = Measures::of(&black, &black, &[false; 4]);
        assert_eq!(m, Measures::default());
        let m = Measures::of(&[[0.1; 3]; 4], &black, &[false; 4]);
        assert_eq!(m.relative_rmse, f64::INFINITY);
        assert_eq!(m.bias, f64::INFINITY);
        assert_eq!(m.median, f64::INFINITY);
        let m = Measures::of(&[[-0.1; 3]; 4], &black, &[false; 4]);
        assert_eq!(m.bias, f64::NEG_INFINITY);
    }

    #[test]
    fn nothing_open_is_no_error_and_nan_is_never_good() {
        assert_eq!(Measures::of(&[[1.0; 3]], &[[0.0; 3]], &[true]), Measures::default());
        let m = Measures::of(&[[f32::NAN, 1.0, 1.0], [1.0; 3]], &[[1.0; 3]; 2], &[false; 2]);
        assert!(m.relative_rmse.is_nan() && m.bias.is_nan() && m.median.is_nan() && m.p99.is_nan());
    }
}
