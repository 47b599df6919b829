//! Study of scenes with contacts and joints: rolling wheel, dropped foot, ragdoll, bridge, cloth and box at a wall.
//!
//! These scenes have no known true motion, so each scene has its own figures.

mod avian;
mod figures;
mod rapier;
mod scenes;
mod section;
mod stage;

use crate::clock::{Times, Track, race_on};
use crate::method::{Dial, Method, Setting};
use crate::paint::Drawn;
use crate::rig::Rig;
use crate::scenes::GRAVITY;
use crate::study::{Study, number};
use bevy::math::Vec3;
use figures::{RATE, Run};
use scenes::{SCENES, Scene};
use stage::Stage;
use std::error::Error;
use std::path::Path;

/// Number of updates before timing starts: by then the falling bodies have landed.
const WARM_UP: u32 = 60;
/// Simulated time after which a timed scene restarts, s.
const LONGEST: f64 = 10.0;

/// Result of a setting in a scene.
pub struct Told {
    scene: &'static Scene,
    /// Speed that the scene varies, m/s. 0 if it varies none.
    speed: f32,
    setting: Setting,
    /// Figures in the order of the scene's `heads`.
    figures: Vec<f64>,
    times: Times,
    /// Whether it was measured in a release build.
    release: bool,
}

/// The study of all scenes with contacts or joints.
pub struct Ground;

impl Study for Ground {
    type Item = Told;

    fn name(&self) -> &'static str {
        "ground"
    }

    fn wanted(&self, method: Method, quick: bool) -> usize {
        let cases = cases(quick)
            .filter(|(scene, speed)| can(method, &(scene.make)(*speed)))
            .count();
        cases * settings(method).len()
    }

    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Told>, Box<dyn Error>> {
        let turns = if quick { 5 } else { 15 };
        let mut told = Vec::new();
        for (scene, speed) in cases(quick) {
            told.extend(measure(scene, speed, methods, turns));
        }
        Ok(told)
    }

    fn method(item: &Told) -> Method {
        item.setting.method
    }

    fn header(&self) -> String {
        "scene,speed,method,setting,figure_1,figure_2,step_us,step_us_quartile_1,step_us_quartile_3,build".into()
    }

    fn line(t: &Told) -> String {
        let figure = |i: usize| t.figures.get(i).map(|f| format!("{f:.5e}"));
        let us = |s: f64| format!("{:.2}", 1e6 * s);
        format!(
            "{},{},{},{},{},{},{},{},{},{}",
            t.scene.name,
            t.speed,
            t.setting.method.name(),
            t.setting.dial,
            figure(0).unwrap_or_default(),
            figure(1).unwrap_or_default(),
            us(t.times.mean),
            us(t.times.low),
            us(t.times.high),
            if t.release { "release" } else { "dev" },
        )
    }

    fn parse(cells: &[&str]) -> Option<Told> {
        let [scene, speed, method, dial, one, two, mean, low, high, build] = cells else {
            return None;
        };
        let method = Method::named(method)?;
        let us = |cell: &str| number(cell).map(|us| 1e-6 * us);
        Some(Told {
            scene: SCENES.iter().find(|s| s.name == *scene)?,
            speed: speed.parse().ok()?,
            setting: settings(method)
                .into_iter()
                .find(|s| s.dial.to_string() == *dial)?,
            figures: [one, two].into_iter().filter_map(|f| number(f)).collect(),
            times: Times {
                mean: us(mean)?,
                low: us(low)?,
                high: us(high)?,
            },
            release: *build == "release",
        })
    }

    /// Draws nothing: the figures have different units and do not fit into one chart.
    fn draw(&self, _: &Path, _: &[Told]) -> Drawn {
        Ok(())
    }

    fn section(&self, items: &[Told]) -> String {
        section::section(items)
    }
}

/// Pairs of a scene and a speed. A quick run has only the last speed of each quick scene.
fn cases(quick: bool) -> impl Iterator<Item = (&'static Scene, f32)> {
    let scenes = SCENES.iter().filter(move |s| s.quick || !quick);
    scenes.flat_map(move |scene| {
        let few = if quick { 1 } else { scene.speeds.len() };
        scene
            .speeds
            .iter()
            .rev()
            .take(few)
            .rev()
            .map(move |v| (scene, *v))
    })
}

/// The default setting of a method, and one with a finer dial if that dial also refines contacts and joints.
fn settings(method: Method) -> Vec<Setting> {
    let dials = match method {
        Method::Ours => vec![method.default_dial()],
        Method::Joint => vec![method.default_dial(), Dial::Iterations(16)],
        Method::Avian => vec![method.default_dial(), Dial::Substeps(24)],
        Method::Force | Method::AvianBare => Vec::new(),
    };
    let setting = |dial| Setting {
        method,
        dial,
        rate: RATE,
    };
    dials.into_iter().map(setting).collect()
}

/// Whether a method's engine has all joint types of a stage.
fn can(method: Method, stage: &Stage) -> bool {
    !method.is_avian() || avian::has(stage)
}

fn rig(stage: &Stage, setting: Setting) -> Rig {
    Rig::build(setting, Vec3::NEG_Y * GRAVITY, None, |world| {
        if setting.method.is_avian() {
            avian::fill(world, stage, setting.method)
        } else {
            rapier::fill(world, stage, setting.method)
        }
    })
}

fn measure(scene: &'static Scene, speed: f32, methods: &[Method], turns: u32) -> Vec<Told> {
    let stage = (scene.make)(speed);
    let able = methods.iter().filter(|method| can(**method, &stage));
    let settings: Vec<Setting> = able.flat_map(|method| settings(*method)).collect();
    let figures: Vec<Vec<f64>> = settings
        .iter()
        .map(|setting| {
            let rig = rig(&stage, *setting);
            (scene.figures)(&mut Run { stage: &stage, rig })
        })
        .collect();
    let track = Track {
        make: &|setting| rig(&stage, setting),
        warm_up: WARM_UP,
        longest: LONGEST,
        spread: f64::INFINITY,
    };
    let times = race_on(&track, &settings, turns);
    let all = settings.into_iter().zip(figures).zip(times);
    all.map(|((setting, figures), times)| Told {
        scene,
        speed,
        setting,
        figures,
        times,
        release: !cfg!(debug_assertions),
    })
    .collect()
}
