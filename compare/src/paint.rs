//! Colours, fonts and axis ranges shared by the charts.

use crate::method::Method;
use plotters::coord::Shift;
use plotters::coord::combinators::LogCoord;
use plotters::prelude::*;
use std::error::Error;

/// Drawing area of an SVG file.
pub type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Result of drawing.
pub type Drawn = Result<(), Box<dyn Error>>;

/// Chart with two logarithmic axes.
pub type Chart<'a, 'b> =
    ChartContext<'a, SVGBackend<'b>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

pub const INK: RGBColor = RGBColor(40, 44, 52);
pub const FAINT: RGBColor = RGBColor(225, 228, 232);

/// Colour of bevy_coilover with extrapolation (fourth order).
pub const EXTRAPOLATED: RGBColor = RGBColor(110, 60, 190);

/// The colour of a method in every chart.
pub fn colour(method: Method) -> RGBColor {
    match method {
        Method::Ours => RGBColor(20, 90, 200),
        Method::Force => RGBColor(200, 40, 50),
        Method::Joint => RGBColor(230, 130, 0),
        Method::Avian => RGBColor(30, 140, 70),
        Method::AvianBare => RGBColor(130, 190, 120),
    }
}

/// The default sans-serif font of the viewer's system, in a size in px.
pub fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

/// Range of a logarithmic axis that holds all positive finite values: with a margin, or whole decades if `whole`.
pub fn decades(values: impl Iterator<Item = f64>, whole: bool) -> std::ops::Range<f64> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for v in values.filter(|v| v.is_finite() && *v > 0.0) {
        (low, high) = (low.min(v), high.max(v));
    }
    if low > high {
        return 0.1..10.0;
    }
    if whole {
        10.0_f64.powf(low.log10().floor())..10.0_f64.powf(high.log10().ceil())
    } else {
        low / 1.6..high * 1.6
    }
}

/// How the numbers at an axis are written.
pub type Label = dyn Fn(&f64) -> String;

/// Draws the axes of a chart with faint lines at their numbers. `size` is that of the letters, px; titles and labels are those of
/// the x axis and of the y axis.
pub fn axes(chart: &mut Chart, size: u32, titles: [&str; 2], labels: [&Label; 2]) -> Drawn {
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(FAINT)
        .axis_style(INK)
        .label_style(font(size))
        .x_desc(titles[0])
        .y_desc(titles[1])
        .x_label_formatter(labels[0])
        .y_label_formatter(labels[1])
        .draw()?;
    Ok(())
}
