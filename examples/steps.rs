//! So many steps of 1 ms of the embedded humanoid on its stand, for counting instructions:
//! `valgrind --tool=callgrind target/release/examples/steps 12000`, less the same with 2000.

use realnoid::cli::load::{Source, load};
use realnoid::model::Base;
use realnoid::world::{Settings, World};

fn main() -> Result<(), String> {
    let steps = std::env::args().nth(1).and_then(|text| text.parse().ok()).ok_or("usage: steps NUMBER")?;
    let loaded = load(Source { urdf: None, packages: &[] }, Base::Fixed)?;
    let mut world = World::new(loaded.model, Settings { steps_per_interval: 1, ..Settings::default() })?;
    (0..steps).for_each(|_: u32| world.advance());
    println!("{:?}", world.energy());
    Ok(())
}
