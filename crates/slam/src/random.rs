//! Random numbers that depend on the seed, the update and the particle, and not on who draws first.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

/// The stream of what concerns all particles.
pub(crate) const ALL: u32 = u32::MAX;

/// The numbers of a particle in an update.
pub(crate) fn stream(seed: u64, update: u32, particle: u32) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(u64::from(update) << 32 | u64::from(particle));
    rng
}
