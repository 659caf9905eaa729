//! A door's leaf on its way between shut and open.

use super::room::{Among, Piece, Room, Who};
use crate::Door;

/// The free edge moves at most so far before the leaf looks again, m.
const STEP_M: f64 = 0.01;

/// A leaf. Its angle is set, not driven by a joint's motor: a motor leaves the leaf off its angle by what the solver
/// tolerates, and a kinematic person pushes it aside without limit.
pub(super) struct Leaf<'a> {
    door: &'a Door,
    pub(super) piece: Piece,
    angle_rad: f64,
}

impl<'a> Leaf<'a> {
    pub(super) fn new(door: &'a Door, thing: usize, seed: u64, room: &mut Room) -> Self {
        let angle_rad = door.angle_at_start(seed);
        Self { door, piece: room.add(&door.leaf(angle_rad), Who::Thing(thing)), angle_rad }
    }

    pub(super) fn shape(&self) -> crate::Shape {
        self.door.leaf(self.angle_rad)
    }

    /// Turns towards open or shut for so long, as far as nobody stands in its swing.
    pub(super) fn swing(&mut self, open: bool, dt_s: f64, room: &mut Room) {
        let Door { closed_rad, open_rad, swing_s, length_m, .. } = *self.door;
        let target = if open { open_rad } else { closed_rad };
        let most = (open_rad - closed_rad).abs() / swing_s * dt_s;
        let mut left = (target - self.angle_rad).clamp(-most, most);
        while left.abs() > 0.0 {
            let turn = left.clamp(-STEP_M / length_m, STEP_M / length_m);
            left -= turn;
            // The last turn ends where it should, to the last bit.
            let to =
                if left.abs() > 0.0 || (target - self.angle_rad).abs() > most { self.angle_rad + turn } else { target };
            let leaf = self.door.leaf(to);
            if !room.is_free(self.piece, &leaf, Among::Moving) {
                return;
            }
            self.angle_rad = to;
            if let crate::Shape::Box { center_m, axis, .. } = leaf {
                room.place(self.piece, center_m, axis);
            }
        }
    }
}
