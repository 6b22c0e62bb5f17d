//! Positions of the joints of a BVH file on a frame (forward kinematics).
//!
//! The frame of a node is that of its parent, shifted by the node's offset and then rotated by its rotation channels in
//! the order of the file. With column vectors R = R₁ R₂ R₃: the last channel rotates first, and its axes are carried
//! along by the others. Ends of chains are only shifted.
//!
//! A position channel replaces the offset on its axis, as in animation programs. Files with positions for every joint
//! repeat the offset in them. Files with positions for the root have an offset of 0 or the same value there.

use super::parse::{Bvh, Channel};
use glam::{DMat3, DVec3};

/// The positions of all nodes on a frame, in the unit and axes of the file.
pub fn nodes_at(bvh: &Bvh, frame: usize) -> Vec<DVec3> {
    let mut values = bvh.frame(frame).iter();
    let mut found: Vec<(DVec3, DMat3)> = Vec::with_capacity(bvh.nodes.len());
    for node in &bvh.nodes {
        let (mut shift, mut turn) = (node.offset, DMat3::IDENTITY);
        for (channel, value) in node.channels.iter().zip(&mut values) {
            match channel {
                Channel::Position(axis) => shift[*axis] = *value,
                Channel::Rotation(axis) => turn *= about(*axis, value.to_radians()),
            }
        }
        let (origin, frame) = node.parent.map_or((DVec3::ZERO, DMat3::IDENTITY), |parent| found[parent]);
        found.push((origin + frame * shift, frame * turn));
    }
    found.into_iter().map(|(place, _)| place).collect()
}

fn about(axis: usize, angle: f64) -> DMat3 {
    match axis {
        0 => DMat3::from_rotation_x(angle),
        1 => DMat3::from_rotation_y(angle),
        _ => DMat3::from_rotation_z(angle),
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;

    /// A root with an arm of length 2 along y, and a hand of length 1 along x at its end.
    fn posed(channels: &str, frame: &str) -> Vec<DVec3> {
        let text = format!(
            "HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\n{channels}\nJOINT b\n{{\nOFFSET 0 2 0\nCHANNELS 1 Zrotation\nEnd Site\n\
             {{\nOFFSET 1 0 0\n}}\n}}\n}}\nMOTION\nFrames: 1\nFrame Time: 1\n{frame}\n"
        );
        nodes_at(&parse(&text).unwrap(), 0)
    }

    fn near(found: &[DVec3], expected: [[f64; 3]; 3]) {
        let expected = expected.map(DVec3::from);
        assert!(found.iter().zip(&expected).all(|(a, b)| a.distance(*b) < 1e-12), "{found:?} {expected:?}");
    }

    #[test]
    fn the_last_rotation_turns_first() {
        near(
            &posed("CHANNELS 2 Zrotation Xrotation", "90 90 0"),
            [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 1.0, 2.0]], // x to y by z; y to z by x
        );
        near(
            &posed("CHANNELS 2 Xrotation Zrotation", "90 90 0"),
            [[0.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [-2.0, 0.0, 1.0]],
        );
        near(&posed("CHANNELS 1 Yrotation", "90 0"), [[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 2.0, -1.0]]);
        near(
            &posed("CHANNELS 3 Zrotation Xrotation Zrotation", "90 90 90 0"),
            [
                [0.0, 0.0, 0.0],
                [0.0, -2.0, 0.0], // y to −x, stays, to −y
                [0.0, -2.0, 1.0], // x to y, to z, stays
            ],
        );
    }

    #[test]
    fn turns_are_carried_along_and_positions_stand_in_place_of_offsets() {
        near(
            &posed("CHANNELS 4 Zrotation Yposition Xposition Zposition", "90 5 4 6 90"),
            [[4.0, 5.0, 6.0], [2.0, 5.0, 6.0], [1.0, 5.0, 6.0]],
        );
        near(&posed("CHANNELS 1 yposition", "7 0"), [[0.0, 7.0, 0.0], [0.0, 9.0, 0.0], [1.0, 9.0, 0.0]]);
    }
}
