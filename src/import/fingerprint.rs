//! A fingerprint of a scene's content, so that an image can be traced back to what made it.

use crate::scene::desc::{InfiniteLightKind, SceneDesc, ShapeDesc, TextureDesc};

/// Two lanes of multiply-and-rotate over 64-bit words. Not cryptographic: it tells versions of a scene apart, it does
/// not defend against anyone.
struct Fingerprint([u64; 2]);

impl Fingerprint {
    fn word(&mut self, w: u64) {
        let [a, b] = &mut self.0;
        *a = (*a ^ w).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        *b = (*b ^ w.rotate_left(32)).wrapping_mul(0xc2b2_ae3d_27d4_eb4f).rotate_left(31);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.word(u64::from_le_bytes(word));
        }
    }

    fn floats<const N: usize>(&mut self, list: &[[f32; N]]) {
        self.word(list.len() as u64);
        for x in list.as_flattened() {
            self.word(u64::from(x.to_bits()));
        }
    }
}

/// 128 bits that change with the scene's text and with the content of its meshes and images, and with nothing else: not with
/// where the files are.
pub fn fingerprint(text: &str, scene: &SceneDesc) -> u128 {
    let mut f = Fingerprint([0x243f_6a88_85a3_08d3, 0x1319_8a2e_0370_7344]);
    f.bytes(text.as_bytes());
    for surface in &scene.surfaces {
        if let ShapeDesc::Mesh(mesh) = &surface.shape {
            f.floats(&mesh.positions);
            f.floats(&mesh.normals);
            f.floats(&mesh.uvs);
            f.word(mesh.triangles.len() as u64);
            for index in mesh.triangles.as_flattened() {
                f.word(u64::from(*index));
            }
        }
    }
    for texture in &scene.textures {
        if let TextureDesc::Image { texels, .. } = texture {
            f.word(u64::from(texels.width));
            f.floats(&texels.rgb);
        }
    }
    for light in &scene.infinite_lights {
        if let InfiniteLightKind::Image { size, texels, .. } = &light.kind {
            f.word(size[0] as u64);
            f.floats(texels);
        }
    }
    let [mut a, mut b] = f.0;
    a ^= a >> 32;
    b ^= b >> 29;
    u128::from(a.wrapping_mul(0xd6e8_feb8_6659_fd93)) << 64 | u128::from(b.wrapping_mul(0xd6e8_feb8_6659_fd93))
}
