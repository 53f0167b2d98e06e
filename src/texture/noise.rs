//! Gradient noise [Perlin02] on a hashed lattice, and turbulence, its octaves summed.

use crate::math::DVec3;

/// Octaves of `turbulence`: those of the textures it is to look like.
const OCTAVES: u32 = 7;

/// Gradient noise in [−1, 1], zero at the points of the integer lattice, with two continuous derivatives.
pub(super) fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    // Far beyond 2⁶³ the cast saturates; there is no fraction left to interpolate by, either.
    let [i, j, k] = [cell.x as i64, cell.y as i64, cell.z as i64];
    let corner = |a: i64, b: i64, c: i64| {
        let h = hash(i.wrapping_add(a), j.wrapping_add(b), k.wrapping_add(c));
        gradient(h, f - DVec3::new(a as f64, b as f64, c as f64))
    };
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let lerp = |t: f64, a: f64, b: f64| a + t * (b - a);
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let plane = |c: i64| {
        let near = lerp(u, corner(0, 0, c), corner(1, 0, c));
        lerp(v, near, lerp(u, corner(0, 1, c), corner(1, 1, c)))
    };
    lerp(w, plane(0), plane(1))
}

/// |Σ 2⁻ⁱ noise(2ⁱ p)|.
pub(super) fn turbulence(p: DVec3) -> f64 {
    let (mut sum, mut weight, mut p) = (0.0, 1.0, p);
    for _ in 0..OCTAVES {
        sum += weight * noise(p);
        weight *= 0.5;
        p *= 2.0;
    }
    f64::abs(sum)
}

/// Hash of a lattice point, by rounds of SplitMix64's finaliser.
fn hash(i: i64, j: i64, k: i64) -> u64 {
    let mix = |mut z: u64| {
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    mix(mix(mix(i as u64 ^ 0x9e37_79b9_7f4a_7c15) ^ j as u64) ^ k as u64)
}

/// The product of `d` with one of the 12 directions to the middles of a cube's edges, four of them twice [Perlin02].
fn gradient(hash: u64, d: DVec3) -> f64 {
    let h = hash & 15;
    let u = if h < 8 { d.x } else { d.y };
    let v = if h < 4 {
        d.y
    } else if h == 12 || h == 14 {
        d.x
    } else {
        d.z
    };
    (if h & 1 == 0 { u } else { -u }) + (if h & 2 == 0 { v } else { -v })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero_on_the_lattice_and_continuous_across_cells() {
        let mut largest = 0.0_f64;
        for n in 0..2000 {
            let t = f64::from(n);
            let p = DVec3::new((t * 0.618).fract() * 20.0 - 10.0, (t * 0.755).fract() * 20.0 - 10.0, t * 0.01);
            assert_eq!(noise(p.round()), 0.0);
            let x = noise(p);
            assert!(x.abs() <= 1.0, "{x} at {p}");
            largest = largest.max(x.abs());
            // The cell's wall at x = round: both sides agree.
            let wall = DVec3::new(p.x.round(), p.y, p.z);
            let (a, b) = (noise(wall - DVec3::X * 1e-9), noise(wall + DVec3::X * 1e-9));
            assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
        assert!(largest > 0.5, "{largest}");
    }
}
