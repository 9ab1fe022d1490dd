//! A chart's axes, and where its data are on the canvas.

use kuva::TickFormat;
use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::render_multiple;

use super::canvas::Canvas;
use super::style::{CURVE, text};

/// An axis: what it is called, and the values at its two ends.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name, with the unit in brackets.
    pub label: String,
    /// First and last value.
    pub range: [f64; 2],
    /// Distance of two ticks, where it is not left to the chart.
    pub step: Option<f64>,
    /// Whether the values are spaced by their logarithm.
    pub logarithmic: bool,
    /// Whether numbers stand along it.
    pub numbered: bool,
    /// Whether it has ticks and a grid at all.
    pub ticked: bool,
    /// About how many ticks.
    pub ticks: usize,
}

impl Axis {
    /// An axis over a range.
    pub fn new(label: impl Into<String>, range: [f64; 2]) -> Axis {
        let range = if range[1] > range[0] { range } else { [range[0] - 0.5, range[0] + 0.5] };
        Axis { label: label.into(), range, step: None, logarithmic: false, numbered: true, ticked: true, ticks: 8 }
    }

    /// An axis over all these values, with some room on both sides.
    pub fn over(label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Axis {
        Axis::new(label, widened(values, 0.06))
    }

    /// The same with a step between its ticks.
    pub fn every(self, step: f64) -> Axis {
        Axis { step: Some(step), ..self }
    }

    /// The same over logarithms.
    pub fn logarithmic(self) -> Axis {
        Axis { logarithmic: true, ..self }
    }

    /// The same with about so many ticks.
    pub fn ticks(self, ticks: usize) -> Axis {
        Axis { ticks, ..self }
    }

    /// The same without ticks and without numbers.
    pub fn bare(self) -> Axis {
        Axis { ticked: false, ..self }
    }

    /// The distance of two ticks: as it was asked for, or the round number that gives about as many as are wanted, two at least.
    fn spacing(&self) -> Option<f64> {
        if self.logarithmic || self.step.is_some() {
            return self.step;
        }
        let [low, high] = self.range;
        let rough = (high - low) / self.ticks.max(1) as f64;
        let unit = 10f64.powf(rough.log10().floor());
        let steps = [0.5, 1.0, 2.0, 5.0, 10.0].map(|digit| digit * unit);
        let wanted = steps.iter().position(|step| *step >= rough).unwrap_or(steps.len() - 1);
        // One tick alone tells no distances.
        let enough = |step: &&f64| (high / **step).floor() - (low / **step).ceil() >= 1.0;
        steps.get(..=wanted)?.iter().rev().find(enough).or(steps.get(wanted)).copied()
    }

    /// Numbers with as many digits as tell two ticks apart.
    fn format(&self) -> TickFormat {
        if !self.numbered {
            return TickFormat::Custom(std::sync::Arc::new(|_| String::new()));
        }
        let digits = self.spacing().map_or(0, |step| (-(step * 1.0001).log10().floor()).max(0.0) as usize);
        TickFormat::Custom(std::sync::Arc::new(move |value| {
            // No minus before a zero.
            let value = if value.abs() < 0.5 * 10f64.powi(-(digits as i32)) { 0.0 } else { value };
            format!("{value:.digits$}").replace('-', "\u{2212}")
        }))
    }

    /// The same without numbers.
    pub fn unnumbered(self) -> Axis {
        Axis { numbered: false, ..self }
    }
}

/// The range of values, wider by a share of itself on both sides.
pub fn widened(values: impl IntoIterator<Item = f64>, share: f64) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    if low > high {
        return [0.0, 1.0];
    }
    let room = if high > low { share * (high - low) } else { 0.1 * high.abs().max(1.0) };
    [low - room, high + room]
}

/// A curve in the coordinates of its axes.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its points.
    pub points: Vec<[f64; 2]>,
    /// Its colour.
    pub colour: String,
    /// Its width.
    pub width: f64,
}

impl Curve {
    /// A curve of the usual width.
    pub fn new(points: Vec<[f64; 2]>, colour: &str) -> Curve {
        Curve { points, colour: colour.to_owned(), width: CURVE }
    }
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Upper left corner and size on the canvas, names of axes included.
    pub at: [f64; 2],
    /// Width and height.
    pub size: [f64; 2],
    /// Across.
    pub x: Axis,
    /// Upwards.
    pub y: Axis,
    /// Space for what stands left, right, above and below the data.
    pub margins: Margins,
}

/// Space around the data of a chart.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    /// On the left.
    pub left: f64,
    /// On the right.
    pub right: f64,
    /// Above.
    pub top: f64,
    /// Below.
    pub bottom: f64,
}

impl Default for Margins {
    fn default() -> Margins {
        Margins { left: 86.0, right: 22.0, top: 14.0, bottom: 58.0 }
    }
}

/// Where data are on the canvas.
#[derive(Clone, Copy, Debug)]
pub struct Mapping {
    x: [f64; 2],
    y: [f64; 2],
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    logarithmic: [bool; 2],
}

impl Mapping {
    /// A point of the data on the canvas.
    pub fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let share = |value: f64, [low, high]: [f64; 2], logarithmic: bool| {
            if logarithmic {
                (value.max(1e-10).log10() - low.max(1e-10).log10()) / (high.log10() - low.max(1e-10).log10())
            } else {
                (value - low) / (high - low)
            }
        };
        let across = share(x, self.x, self.logarithmic[0]);
        let up = share(y, self.y, self.logarithmic[1]);
        [self.left + across * self.width, self.top + (1.0 - up) * self.height]
    }

    /// Whether a point of the data lies within the axes.
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.x[0]..=self.x[1]).contains(&x) && (self.y[0]..=self.y[1]).contains(&y)
    }

    /// Left, top, right and bottom of the data on the canvas.
    pub fn frame(&self) -> [f64; 4] {
        [self.left, self.top, self.left + self.width, self.top + self.height]
    }
}

impl Panel {
    /// A chart with the usual margins.
    pub fn new(at: [f64; 2], size: [f64; 2], x: Axis, y: Axis) -> Panel {
        Panel { at, size, x, y, margins: Margins::default() }
    }

    /// Where its data are on the canvas.
    pub fn mapping(&self) -> Mapping {
        let Margins { left, right, top, bottom } = self.margins;
        Mapping {
            x: self.x.range,
            y: self.y.range,
            left: self.at[0] + left,
            top: self.at[1] + top,
            width: self.size[0] - left - right,
            height: self.size[1] - top - bottom,
            logarithmic: [self.x.logarithmic, self.y.logarithmic],
        }
    }

    /// Draws the axes and curves, cut off at the axes. `under` draws what lies behind the curves and before the grid, in the
    /// coordinates of the panel itself, for which it is given the mapping.
    pub fn draw(&self, canvas: &mut Canvas, curves: &[Curve], under: impl FnOnce(&mut Canvas, &Mapping)) -> Mapping {
        // Axes are drawn for a chart of something, be it of no points.
        let mut plots: Vec<Plot> = vec![ScatterPlot::new().with_data(Vec::<(f64, f64)>::new()).into()];
        for curve in curves {
            let points = curve.points.iter().map(|[x, y]| (*x, *y));
            let line =
                LinePlot::new().with_data(points).with_color(curve.colour.as_str()).with_stroke_width(curve.width);
            plots.push(line.into());
        }
        let inside = Panel { at: [0.0, 0.0], ..self.clone() };
        let mut behind = Canvas::new(self.size[0], self.size[1]);
        under(&mut behind, &inside.mapping());
        canvas.place(render_multiple(plots, self.layout()), self.at, Some(behind));
        self.mapping()
    }

    fn layout(&self) -> Layout {
        let Margins { left, right, top, bottom } = self.margins;
        let ([x, x2], [y, y2]) = (self.x.range, self.y.range);
        let mut layout = Layout::new((x, x2), (y, y2))
            .with_width(self.size[0])
            .with_height(self.size[1])
            .with_force_margins(left, right)
            .with_force_margins_y(top, bottom)
            .with_clamp_axis()
            .with_x_axis_min(x)
            .with_x_axis_max(x2)
            .with_y_axis_min(y)
            .with_y_axis_max(y2)
            .with_x_label(self.x.label.as_str())
            .with_y_label(self.y.label.as_str())
            .with_label_size(text::LABEL)
            .with_tick_size(text::TICK)
            .with_ticks(self.x.ticks)
            .with_box_axes();
        if let Some(step) = self.x.spacing() {
            layout = layout.with_x_tick_step(step);
        }
        if let Some(step) = self.y.spacing() {
            layout = layout.with_y_tick_step(step);
        }
        if self.x.logarithmic {
            layout = layout.with_log_x();
        }
        if self.y.logarithmic {
            layout = layout.with_log_y();
        }
        if !self.x.logarithmic {
            layout = layout.with_x_tick_format(self.x.format());
        }
        if !self.y.logarithmic {
            layout = layout.with_y_tick_format(self.y.format());
        }
        layout.suppress_x_ticks = !self.x.ticked;
        layout.suppress_y_ticks = !self.y.ticked;
        layout
    }
}
