//! Arguments of `realnoid effects`.

use crate::cli::start_args::StartArgs;
use clap::Args;

/// `effects`.
#[derive(Debug, Args)]
pub struct EffectsArgs {
    /// Robot, scene and state at start. Effects that are off from the beginning have no price.
    #[command(flatten)]
    pub start: StartArgs,
    /// Simulated time after which the error of a run without an effect is told, s.
    #[arg(long, value_name = "SECONDS", default_value_t = 1.0, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Physics steps that are counted and timed, from the start; rounded up to whole control intervals.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    pub steps: u32,
    /// Rounds of timing, with and without an effect in turns, of which the median is told.
    #[arg(long, default_value_t = 31, value_parser = clap::value_parser!(u32).range(1..))]
    pub rounds: u32,
    /// Instructions are not counted: quicker, and valgrind is not asked for.
    #[arg(long)]
    pub no_count: bool,
    /// JSON instead of a table.
    #[arg(long)]
    pub json: bool,
    /// The table as Markdown.
    #[arg(long, conflicts_with = "json")]
    pub markdown: bool,
    /// Under callgrind: makes the steps that are counted.
    #[arg(long, hide = true)]
    pub count: bool,
}
