//! Runs the studies: measurements beyond the scenes, also stored as CSV.

use crate::method::Method;
use crate::options::Options;
use crate::paint::Drawn;
use indicatif::ProgressBar;
use std::error::Error;
use std::fs;
use std::path::Path;

/// A measurement of every method, with its own table, chart and report section.
pub trait Study {
    type Item;
    /// Name on the command line and of the study's files.
    fn name(&self) -> &'static str;
    /// Number of items of a method in a complete measurement.
    fn wanted(&self, method: Method, quick: bool) -> usize;
    fn measure(&self, methods: &[Method], quick: bool) -> Result<Vec<Self::Item>, Box<dyn Error>>;
    fn method(item: &Self::Item) -> Method;
    fn header(&self) -> String;
    fn line(item: &Self::Item) -> String;
    fn parse(cells: &[&str]) -> Option<Self::Item>;
    fn draw(&self, path: &Path, items: &[Self::Item]) -> Drawn;
    fn section(&self, items: &[Self::Item]) -> String;
}

/// Measures the requested items that are missing, draws all items, and returns the report section.
pub fn run<S: Study>(
    study: &S,
    options: &Options,
    folder: &Path,
    bar: &ProgressBar,
) -> Result<String, Box<dyn Error>> {
    let path = folder.join(format!("{}.csv", study.name()));
    let mut items = open::<S>(&path);
    let missing: Vec<Method> = asked(study, options)
        .into_iter()
        .filter(|method| {
            let there = items.iter().filter(|i| S::method(i) == *method).count();
            there < study.wanted(*method, options.quick) || options.fresh
        })
        .collect();
    if !missing.is_empty() {
        bar.set_message(study.name());
        items.retain(|i| !missing.contains(&S::method(i)));
        items.extend(study.measure(&missing, options.quick)?);
        bar.inc(missing.len() as u64);
    }
    if items.is_empty() {
        return Ok(String::new());
    }
    items.sort_by_key(|i| S::method(i));
    if !missing.is_empty() {
        let lines: Vec<String> = items.iter().map(S::line).collect();
        fs::write(&path, format!("{}\n{}\n", study.header(), lines.join("\n")))?;
        // The file holds rounded numbers: reading them back makes the next run draw the same.
        items = open::<S>(&path);
    }
    study.draw(&folder.join(format!("{}.svg", study.name())), &items)?;
    Ok(study.section(&items))
}

fn open<S: Study>(path: &Path) -> Vec<S::Item> {
    let text = fs::read_to_string(path).unwrap_or_default();
    let cells = |line: &str| S::parse(&line.split(',').collect::<Vec<_>>());
    text.lines().skip(1).filter_map(cells).collect()
}

/// Methods that a study shall measure. Leaves out [`Method::AvianBare`], which differs from Avian only in its damping.
pub fn asked<S: Study>(study: &S, options: &Options) -> Vec<Method> {
    if !options.wants(study.name()) {
        return Vec::new();
    }
    let methods = options.methods.iter().copied();
    methods.filter(|m| *m != Method::AvianBare).collect()
}

/// Parses a number, or returns `None`.
pub fn number(cell: &str) -> Option<f64> {
    cell.parse().ok()
}
