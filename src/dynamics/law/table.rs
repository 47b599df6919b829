//! A monotone curve through points, as a test bench measures them.

/// Piecewise cubic curve through the points, without overshoot (F. N. Fritsch and R. E. Carlson, "Monotone piecewise cubic
/// interpolation", SIAM J. Numer. Anal. 17, 1980). Beyond the points it continues straight with the slope at its ends.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pieces: Vec<Piece>,
    end: f64,
    /// Value, slope and integral at `end`.
    last: [f64; 3],
}

/// value = a + b t + c t² + d t³, where t goes from 0 at `from` to 1 at `from + width`.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f64,
    width: f64,
    coefficients: [f64; 4],
    /// Integral from the first point to `from`.
    before: f64,
}

impl Piece {
    fn at(&self, x: f64) -> [f64; 3] {
        let t = (x - self.from) / self.width;
        let [a, b, c, d] = self.coefficients;
        [
            a + t * (b + t * (c + t * d)),
            (b + t * (2.0 * c + t * 3.0 * d)) / self.width,
            self.before + self.width * t * (a + t * (b / 2.0 + t * (c / 3.0 + t * d / 4.0))),
        ]
    }
}

impl Table {
    /// Curve through at least two points. Their x must strictly rise, and their values must never fall.
    pub(crate) fn new(points: &[(f64, f64)]) -> Self {
        let slopes = slopes(points);
        let mut before = 0.0;
        let pieces: Vec<Piece> = points
            .windows(2)
            .zip(slopes.windows(2))
            .map(|(p, m)| {
                let width = p[1].0 - p[0].0;
                let rise = p[1].1 - p[0].1;
                let (b, c) = (width * m[0], 3.0 * rise - width * (2.0 * m[0] + m[1]));
                let piece = Piece {
                    from: p[0].0,
                    width,
                    coefficients: [p[0].1, b, c, width * (m[0] + m[1]) - 2.0 * rise],
                    before,
                };
                before = piece.at(p[1].0)[2];
                piece
            })
            .collect();
        let end = points.last().map_or(0.0, |p| p.0);
        let last = pieces.last().map_or([0.0; 3], |piece| piece.at(end));
        Self { pieces, end, last }
    }

    /// Returns the value, the slope, and the integral from the first point.
    pub(crate) fn at(&self, x: f64) -> [f64; 3] {
        let straight = |[value, slope, integral]: [f64; 3], past: f64| {
            [
                value + slope * past,
                slope,
                integral + past * (value + 0.5 * slope * past),
            ]
        };
        let next = self.pieces.partition_point(|piece| piece.from <= x);
        match self.pieces.get(next.saturating_sub(1)) {
            Some(first) if next == 0 => straight(first.at(first.from), x - first.from),
            Some(piece) if x <= self.end => piece.at(x),
            _ => straight(self.last, x - self.end),
        }
    }
}

/// Slopes at the points: weighted harmonic means of the mean slopes of both neighbouring pieces, which never overshoot.
fn slopes(points: &[(f64, f64)]) -> Vec<f64> {
    let secant = |i: usize| {
        let (a, b) = (points[i], points[i + 1]);
        (b.1 - a.1) / (b.0 - a.0)
    };
    let width = |i: usize| points[i + 1].0 - points[i].0;
    let last = points.len().saturating_sub(1);
    (0..points.len())
        .map(|i| match i {
            _ if last == 0 => 0.0,
            0 => secant(0),
            i if i == last => secant(last - 1),
            i => {
                let (left, right) = (secant(i - 1), secant(i));
                if left * right <= 0.0 {
                    return 0.0;
                }
                let (w1, w2) = (2.0 * width(i) + width(i - 1), width(i) + 2.0 * width(i - 1));
                (w1 + w2) / (w1 / left + w2 / right)
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_meets_its_points_rises_everywhere_and_goes_straight_on() {
        let points = [
            (-1.0, -4.0),
            (-0.2, -4.0),
            (0.0, 0.0),
            (0.1, 3.0),
            (2.0, 3.5),
        ];
        let table = Table::new(&points);
        for (x, y) in points {
            assert!((table.at(x)[0] - y).abs() < 1e-12, "at {x}");
        }
        let mut last = f64::NEG_INFINITY;
        for i in -300..=600 {
            let x = f64::from(i) * 0.01;
            let [value, slope, integral] = table.at(x);
            assert!(value >= last - 1e-12 && slope >= -1e-12, "falls at {x}");
            last = value;
            let h = 1e-5;
            let numeric = (table.at(x + h)[2] - table.at(x - h)[2]) / (2.0 * h);
            assert!((numeric - value).abs() < 1e-3, "integral {integral} at {x}");
        }
        let [far, slope, _] = table.at(5.0);
        assert!((far - (3.5 + 3.0 * slope)).abs() < 1e-12);
    }
}
