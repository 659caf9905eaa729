//! A chair between its moves.

use super::room::{Among, Piece, Room, Who};
use crate::{Chair, Due, Shape};

pub(super) struct Seat<'a> {
    chair: &'a Chair,
    piece: Piece,
    /// Moves that were made.
    made: usize,
}

impl<'a> Seat<'a> {
    pub(super) fn new(chair: &'a Chair, thing: usize, room: &mut Room) -> Self {
        Self { chair, piece: room.add(&chair.shape, Who::Thing(thing)), made: 0 }
    }

    pub(super) fn shape(&self) -> &Shape {
        self.made.checked_sub(1).map_or(&self.chair.shape, |last| &self.chair.moves[last].shape)
    }

    /// Makes the moves that are due, in order, as far as their places are free.
    pub(super) fn rearrange(&mut self, time_s: f64, ended_stages: usize, room: &mut Room) {
        while let Some(next) = self.chair.moves.get(self.made) {
            let due = match next.due {
                Due::At(at_s) => time_s >= at_s,
                Due::AfterStage(stage) => ended_stages > stage,
            };
            if !(due && room.is_free(self.piece, &next.shape, Among::All)) {
                return;
            }
            match next.shape {
                Shape::Box { center_m, axis, .. } => room.place(self.piece, center_m, axis),
                Shape::Disc { center_m, .. } => room.place(self.piece, center_m, [1.0, 0.0]),
                Shape::Polygon { .. } => {}
            }
            self.made += 1;
        }
    }
}
