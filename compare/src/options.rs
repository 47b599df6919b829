//! The command line.

use crate::method::Method;
use lexopt::prelude::*;
use std::path::PathBuf;

pub const HELP: &str = "\
Speed against error: bevy_coilover beside what a game could use instead.

cargo run --release -p compare -- [OPTIONS]

  --scene NAME    only this scene; may be given again (see --list)
  --method NAME   only this method: ours, force, joint, avian, avian-bare; may be given again
  --quick         few settings, few repeats, two time steps
  --fresh         measure again what the tables already hold
  --report        measure nothing, write report and charts from the tables
  --out DIR       write DIR/docs/speed_vs_error.md and the table in DIR/docs/accuracy.md (default: the repository)
  --describe DIR  write the scenes of points as text, for compare/peers
  --list          print the scenes' names
  --help          print this

Writes docs/speed_vs_error.md, docs/speed_vs_error/*.csv and *.svg. Rows that the tables already hold are not
measured again, so a run that was stopped goes on where it was.";

/// Options of a measuring run.
pub struct Options {
    scenes: Vec<String>,
    pub methods: Vec<Method>,
    pub quick: bool,
    pub fresh: bool,
    report: bool,
    pub out: PathBuf,
}

/// What the command line asks the program to do.
pub enum Request {
    Run(Options),
    Help,
    List,
    /// Measure one method with a number of springs for the scale study, which starts a process for each of these.
    Scale(Method, u32),
    /// Write the scenes as text into a folder.
    Describe(PathBuf),
    /// Run updates under an instruction counter: number of body pairs, number of pairs with a bevy_coilover spring, and
    /// number of updates.
    Updates([u32; 3]),
}

impl Options {
    pub fn wants(&self, scene: &str) -> bool {
        !self.report && (self.scenes.is_empty() || self.scenes.iter().any(|s| s == scene))
    }

    /// Number of timed turns per setting.
    pub fn turns(&self) -> u32 {
        if self.quick { 5 } else { 15 }
    }

    /// Reads the command line. `known` lists the valid scene names.
    pub fn parse(known: &[&str]) -> Result<Request, lexopt::Error> {
        let mut options = Self {
            scenes: Vec::new(),
            methods: Vec::new(),
            quick: false,
            fresh: false,
            report: false,
            out: PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")),
        };
        let mut parser = lexopt::Parser::from_env();
        while let Some(argument) = parser.next()? {
            match argument {
                Long("scene") => {
                    let name = parser.value()?.string()?;
                    if !known.contains(&name.as_str()) {
                        return Err(format!("no scene {name:?}; there are {known:?}").into());
                    }
                    options.scenes.push(name);
                }
                Long("method") => options.methods.push(method(&parser.value()?.string()?)?),
                Long("quick") => options.quick = true,
                Long("fresh") => options.fresh = true,
                Long("report") => options.report = true,
                Long("out") => options.out = parser.value()?.into(),
                Long("list") => return Ok(Request::List),
                Short('h') | Long("help") => return Ok(Request::Help),
                Long("scale-of") => {
                    let method = method(&parser.value()?.string()?)?;
                    return Ok(Request::Scale(method, parser.value()?.parse()?));
                }
                Long("describe") => return Ok(Request::Describe(parser.value()?.into())),
                Long("updates") => {
                    let mut number = || parser.value()?.parse();
                    return Ok(Request::Updates([number()?, number()?, number()?]));
                }
                other => return Err(other.unexpected()),
            }
        }
        if options.methods.is_empty() {
            options.methods = Method::ALL.to_vec();
        }
        Ok(Request::Run(options))
    }
}

fn method(name: &str) -> Result<Method, lexopt::Error> {
    Method::named(name).ok_or_else(|| format!("no method {name:?}").into())
}
