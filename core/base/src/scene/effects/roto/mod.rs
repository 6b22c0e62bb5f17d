//! The parameters of Rototoon Roto.

mod picture;
mod shapes;

use super::EffectParameter;
use picture::PICTURE_PARAMETERS;
use shapes::SHAPE_PARAMETERS;

const FRAMES: [i32; 2] = [-1_000_000, 1_000_000];
const COUNT: usize = SHAPE_PARAMETERS.len() + PICTURE_PARAMETERS.len();

/// Rototoon Roto: every parameter in order.
pub const ROTO: [EffectParameter; COUNT] = {
    let mut all = [SHAPE_PARAMETERS[0]; COUNT];
    let mut index = 0;
    while index < COUNT {
        let beyond = index >= SHAPE_PARAMETERS.len();
        all[index] = if beyond { PICTURE_PARAMETERS[index - SHAPE_PARAMETERS.len()] } else { SHAPE_PARAMETERS[index] };
        index += 1;
    }
    all
};
