//! Textures as written, brought into render space.

use std::sync::Arc;

use super::desc::{self, Color, Param, TextureDesc};
use super::material::rgb;
use crate::math::DVec3;
use crate::texture::{Checker, ImageTexture, Marble, Texture, ToWorld, Wrap};

/// The textures of a scene, by the file's index; each stands after those it is made of.
pub(super) fn build(textures: &[TextureDesc], to_world: ToWorld) -> Vec<Texture> {
    let mut built: Vec<Texture> = Vec::with_capacity(textures.len());
    for texture in textures {
        let part = |param: &Param<Color>| match *param {
            Param::Value(c) => Texture::Constant(rgb(c)),
            Param::Texture(i) => built[i].clone(),
        };
        let next = match texture {
            TextureDesc::Constant(c) => Texture::Constant(rgb(*c)),
            TextureDesc::Checker { scale, even, odd } => Texture::Checker(Arc::new(Checker {
                to_world,
                scale: DVec3::from(*scale),
                even: part(even),
                odd: part(odd),
            })),
            TextureDesc::Marble { scale, base, veins } => {
                Texture::Marble(Arc::new(Marble { to_world, scale: *scale, base: part(base), veins: part(veins) }))
            }
            TextureDesc::Image { texels, scale, wrap, filter } => {
                let wrap = match wrap {
                    desc::Wrap::Repeat => Wrap::Repeat,
                    desc::Wrap::Clamp => Wrap::Clamp,
                };
                let bilinear = *filter == desc::Filter::Bilinear;
                let size = [texels.width, texels.height];
                ImageTexture::new(Arc::clone(&texels.rgb), size, *scale as f32, wrap, bilinear)
                    // The importer checks sizes; an image without texels is black.
                    .map_or(Texture::Constant(crate::math::Rgb::ZERO), Texture::Image)
            }
        };
        built.push(next);
    }
    built
}
