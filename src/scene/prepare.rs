//! From a scene as written to one that can be rendered: everything is brought into *render space*.
//!
//! Render space is the world recentred (`space`) and scaled by a power of two so that the largest coordinate lies in
//! [½, 1). Both are exact in what matters: a scene written at 2ᵏ times the size prepares to the
//! same bits. Radiance does not change with scale; radiant intensity does, with its square (E = I/r²).

use std::ops::Range;

use super::cameras::{camera, reach, shears};
use super::desc::{
    Diagnostic, InfiniteLightDesc, InfiniteLightKind, MaterialKind, Param, Place, SceneDesc, SceneError, ShapeDesc,
    SpotProfile, SurfaceDesc, is_black,
};
use super::duplicates::{ShiningTriangles, duplicate_emitters};
use super::material::rgb;
use super::space::{Space, space};
use super::{Details, SceneNeeds, Surface, flat, standing, textures};
use crate::bsdf::Bsdf;
use crate::camera::Camera;
use crate::geometry::{DeltaPoint, Geometry, Quadric, QuadricKind, exact_normal, is_sliver, triangle_area};
use crate::light::{
    AreaLight, Cone, DeltaPlace, DirectionalLight, Emission, Environment, EnvironmentLight, EnvironmentMap, Light,
    PointLight, Profile, SceneBall, SpotLight,
};
use crate::math::{DAffine3, DVec3, Rgb, Vec3};
use crate::texture::{Texture, ToWorld};

/// A scene in render space, before its acceleration structure.
#[derive(Debug)]
pub struct Prepared {
    /// Shapes.
    pub geometry: Geometry,
    /// By surface index; delta points have none.
    pub surfaces: Vec<Surface>,
    /// What varies over surfaces.
    pub details: Details,
    /// Lights of positive power.
    pub lights: Vec<Light>,
    /// The camera.
    pub camera: Camera,
    /// What can be skipped.
    pub needs: SceneNeeds,
    /// Render space = `scale` · (world − `center`), world units.
    pub center: DVec3,
    /// A power of two.
    pub scale: f64,
    /// The spread of what the camera is among, render units: of order 1, but where the scene has something far away.
    pub near: f64,
    /// What the user should know.
    pub warnings: Vec<Warning>,
}

/// Something about the scene that does not stop it from rendering.
pub type Warning = Diagnostic;

/// Brings a scene into render space.
///
/// # Errors
/// When the camera's transform shears or its sizes do not suit the scene's, a transform carries a vertex out of range, or a light's power does not fit an f32.
pub fn prepare(desc: &SceneDesc) -> Result<Prepared, SceneError> {
    let mut errors = Vec::new();
    let Space { center, scale, near } = space(desc, &mut errors);
    let to_render = DAffine3::from_scale(DVec3::splat(scale)) * DAffine3::from_translation(-center);

    let camera_to_render = to_render * desc.camera.transform;
    let m = camera_to_render.matrix3;
    if shears(&m) {
        errors.push(Diagnostic {
            at: desc.camera.at.clone(),
            message: "the camera's transform shears: its axes must stay at right angles; \
                      use from/at/up, a rotation, a translation or a scale"
                .into(),
        });
    }
    if !errors.is_empty() {
        return Err(SceneError { diagnostics: errors });
    }
    let camera = camera(&desc.camera, &camera_to_render, near)?;

    let world = ToWorld { factor: 1.0 / scale, offset: center };
    let details = Details::new(textures::build(&desc.textures, world), desc.materials.iter().map(|m| &m.kind), scale);
    let maps = desc.surfaces.iter().any(|s| s.finish.normal_map.is_some() || s.finish.bump_map.is_some());
    let geometry = Geometry { wants_uv: maps || details.want_uv(), ..Geometry::default() };
    let mut builder = Builder { to_render, scale, center, geometry, details, ..Builder::default() };
    let is_black = |texture: usize| builder.details.texture(texture).largest() == Rgb::ZERO;
    let duplicates = duplicate_emitters(desc, is_black);
    builder.shining = ShiningTriangles::beside(desc, &duplicates, &to_render, is_black);
    for (surface, duplicate) in desc.surfaces.iter().zip(duplicates) {
        if duplicate { builder.pass_over(surface) } else { builder.add(desc, surface) }
    }
    let ball = ball(&builder.geometry);
    for light in &desc.infinite_lights {
        builder.add_infinite(light, ball);
    }
    let Builder { mut geometry, surfaces, models, details, lights, delta_lights, mut warnings, errors, .. } = builder;
    if !errors.is_empty() {
        return Err(SceneError { diagnostics: errors });
    }
    if geometry.normals.iter().all(|n| *n == Vec3::ZERO) {
        // Not only cleared: their memory is given back.
        geometry.normals = Vec::new();
    }
    geometry.cut_outs = details.cut_outs(&surfaces);
    let reach = reach(&camera, &geometry);
    for point in &mut geometry.delta_points {
        *point = DeltaPoint::new(point.position, reach);
    }
    let doubt = |light: usize, surface: u32, height: f32, error: f32| {
        let surface =
            desc.surfaces.iter().filter(|s| !matches!(s.shape, ShapeDesc::DeltaPoint)).nth(surface as usize)?;
        let at = delta_lights.iter().find(|(index, _)| *index == light)?.1.clone();
        let [height, error] = [height, error].map(|x| f64::from(x) / scale);
        let message = format!(
            "light {light} is taken as standing on the surface {}: it is {height:.2} above it, and rays know so large a surface \
             to ±{error:.2} only; what else lies within that of the light may be lit wrongly; make the surface smaller",
            surface.at
        );
        Some(Diagnostic { at, message })
    };
    warnings.extend(standing::doubts(&geometry, &lights, camera_to_render.translation.as_vec3a(), doubt));
    if lights.is_empty() {
        warnings.push(Diagnostic {
            at: desc.camera.at.clone(),
            message: "nothing in the scene shines: the image will be black".into(),
        });
    }
    let opacity = !geometry.cut_outs.is_empty();
    let needs = SceneNeeds { opacity, ..SceneNeeds::of(&models, &lights) };
    Ok(Prepared { geometry, surfaces, details, lights, camera, needs, center, scale, near, warnings })
}

/// The material of each prepared surface, as an index into the scene's materials: delta points are not among them.
pub fn surface_materials(desc: &SceneDesc) -> Vec<u32> {
    let solid = desc.surfaces.iter().filter(|s| !matches!(s.shape, ShapeDesc::DeltaPoint));
    solid.map(|s| s.material as u32).collect()
}

/// Texture coordinates of a quad's corners.
const QUAD_UVS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Collects what surfaces become.
struct Builder {
    to_render: DAffine3,
    scale: f64,
    center: DVec3,
    geometry: Geometry,
    surfaces: Vec<Surface>,
    /// Every model that some surface may turn out to be of, each as a surface of its own.
    models: Vec<Surface>,
    details: Details,
    lights: Vec<Light>,
    /// Point and spot lights by index, with their places in the file.
    delta_lights: Vec<(usize, Place)>,
    shining: ShiningTriangles,
    warnings: Vec<Warning>,
    errors: Vec<Diagnostic>,
}

impl Default for Builder {
    fn default() -> Self {
        Self {
            to_render: DAffine3::IDENTITY,
            scale: 1.0,
            center: DVec3::ZERO,
            geometry: Geometry::default(),
            surfaces: Vec::new(),
            models: Vec::new(),
            details: Details::default(),
            lights: Vec::new(),
            delta_lights: Vec::new(),
            shining: ShiningTriangles::default(),
            warnings: Vec::new(),
            errors: Vec::new(),
        }
    }
}

impl Builder {
    fn add(&mut self, desc: &SceneDesc, surface: &SurfaceDesc) {
        let material = &desc.materials[surface.material];
        let to_render = self.to_render * surface.transform;
        if matches!(surface.shape, ShapeDesc::DeltaPoint) {
            self.add_delta(surface, &material.kind, &to_render);
            return;
        }
        let index = self.surfaces.len() as u32;
        // Of a textured light a stand-in: `textured` below finds its mean.
        let (radiance, dark) = match material.emit {
            Param::Value(c) => (rgb(c), is_black(c)),
            Param::Texture(i) => {
                let bound = self.details.texture(i).largest();
                (bound, bound == Rgb::ZERO)
            }
        };
        let emit = Emission { radiance, two_sided: material.emit_two_sided };
        let light = match &surface.shape {
            ShapeDesc::Quad { size: [w, h] } => {
                let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
                let positions: Vec<DVec3> = corners.iter().map(|[x, y]| DVec3::new(x * w, y * h, 0.0)).collect();
                let triangles = self.add_triangles(
                    surface,
                    &to_render,
                    &positions,
                    (&[], &QUAD_UVS),
                    &[[0, 1, 2], [0, 2, 3]],
                    (index, (!dark).then_some(emit.two_sided)),
                );
                self.triangle_light(triangles, emit, index)
            }
            ShapeDesc::Mesh(mesh) => {
                let positions: Vec<DVec3> = mesh.positions.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
                let attributes = (mesh.normals.as_slice(), mesh.uvs.as_slice());
                let triangles = self.add_triangles(
                    surface,
                    &to_render,
                    &positions,
                    attributes,
                    &mesh.triangles,
                    (index, (!dark).then_some(emit.two_sided)),
                );
                self.check_uvs(surface, material.emit, mesh.uvs.is_empty());
                self.triangle_light(triangles, emit, index)
            }
            ShapeDesc::Sphere { radius } => {
                self.add_quadric(surface, QuadricKind::Sphere, &to_render, *radius, emit, index)
            }
            ShapeDesc::Disk { radius } => {
                self.add_quadric(surface, QuadricKind::Disk, &to_render, *radius, emit, index)
            }
            ShapeDesc::DeltaPoint => None,
        };
        if light.is_none() && !dark {
            self.warn(surface, "the light has no area: it emits nothing".into());
        }
        let light = light.map(|l| match material.emit {
            Param::Texture(i) => l.textured(&self.geometry, self.details.texture(i).clone()),
            Param::Value(_) => l,
        });
        let light = light.map(Light::Area).map(|l| {
            if !l.power().is_finite() {
                self.errors.push(too_bright(&surface.at));
            }
            self.lights.push(l);
            self.lights.len() as u32 - 1
        });
        self.warn_of_even_planes(surface, material.emit);
        let detail = self.details.add(surface.material, surface.finish);
        let models = self.details.models(surface.material);
        self.surfaces.push(Surface { bsdf: models[0], light, detail });
        self.models.extend(models.into_iter().map(|bsdf| Surface { bsdf, light, detail }));
    }

    /// Leaves out an emitter that is there already; its number stays taken.
    fn pass_over(&mut self, surface: &SurfaceDesc) {
        self.warn(surface, "this light is exactly where another one is: it is left out".into());
        self.surfaces.push(Surface { bsdf: Bsdf::Black, light: None, detail: None });
    }

    /// A texture over texture coordinates needs some.
    fn check_uvs(&mut self, surface: &SurfaceDesc, emit: Param<[f64; 3]>, missing: bool) {
        let emit = matches!(emit, Param::Texture(i) if self.details.texture(i).needs_uv());
        if missing && (emit || self.details.follows_uv(surface.material, &surface.finish)) {
            self.errors.push(Diagnostic {
                at: surface.at.clone(),
                message: "an image is laid over this surface, which has no texture coordinates; give its mesh uvs \
                          (`vt` in OBJ, `u` and `v` in PLY, \"uvs\" inline), or use a checker or marble texture"
                    .into(),
            });
        }
    }

    /// A checker in one of its own planes, z = 0 say, shows one colour: by its definition, and to anyone's surprise.
    fn warn_of_even_planes(&mut self, surface: &SurfaceDesc, emit: Param<[f64; 3]>) {
        let by_position = |t: &Texture| matches!(t, Texture::Checker(_) | Texture::Marble(_));
        let uses = |builder: &Self, kind: &dyn Fn(&Texture) -> bool| {
            let emit = matches!(emit, Param::Texture(i) if kind(builder.details.texture(i)));
            emit || builder.details.uses(surface.material, &surface.finish, kind)
        };
        // Most surfaces have none, and their points need not be looked at.
        if !uses(self, &by_position) {
            return;
        }
        let (error, planes) = flat::planes(surface, self.center);
        for (axis, place) in planes {
            if uses(self, &|t| t.is_even_in_plane(axis, place, error)) {
                let message = flat::advice(axis, place, uses(self, &|t| t.is_even_across(axis)));
                self.warn(surface, message);
            }
        }
    }

    fn warn(&mut self, surface: &SurfaceDesc, message: String) {
        self.warnings.push(Diagnostic { at: surface.at.clone(), message });
    }

    fn triangle_light(&self, triangles: Range<u32>, emit: Emission, index: u32) -> Option<AreaLight> {
        (emit.radiance != Rgb::ZERO)
            .then(|| AreaLight::from_triangles(&self.geometry, triangles, emit, index))
            .flatten()
    }

    /// Appends the triangles that have an area and returns their indices.
    fn add_triangles(
        &mut self,
        surface: &SurfaceDesc,
        to_render: &DAffine3,
        positions: &[DVec3],
        (normals, uvs): (&[[f32; 3]], &[[f32; 2]]),
        triangles: &[[u32; 3]],
        (index, shines): (u32, Option<bool>),
    ) -> Range<u32> {
        let Some(first) = u32::try_from(self.geometry.positions.len() + positions.len())
            .ok()
            .map(|_| self.geometry.positions.len() as u32)
        else {
            self.errors.push(Diagnostic {
                at: surface.at.clone(),
                message: "more than 4294967295 vertices in all; split the scene or simplify its meshes".into(),
            });
            return 0..0;
        };
        let inverse_transpose = to_render.matrix3.inverse().transpose();
        self.geometry.positions.extend(positions.iter().map(|p| to_render.transform_point3(*p).as_vec3a()));
        if normals.is_empty() {
            self.geometry.normals.resize(self.geometry.positions.len(), Vec3::ZERO);
        } else {
            let turned = |n: &[f32; 3]| (inverse_transpose * DVec3::from(n.map(f64::from))).normalize_or_zero();
            self.geometry.normals.extend(normals.iter().map(|n| turned(n).as_vec3a()));
        }
        if self.geometry.wants_uv {
            self.geometry.uvs.extend(uvs);
            self.geometry.uvs.resize(self.geometry.positions.len(), [0.0; 2]);
        }
        // A mirroring map turns the winding over but not the side that was meant.
        let flip = surface.flip_normals != (to_render.matrix3.determinant() < 0.0);
        let before = self.geometry.triangles.len() as u32;
        let mut duplicates = 0;
        for &[a, b, c] in triangles {
            let t = if flip { [a, c, b] } else { [a, b, c] };
            let t = t.map(|i| first + i);
            // By the test of the shading, whose normal has to exist in f32.
            let [a, b, c] = t.map(|i| self.geometry.positions[i as usize]);
            if triangle_area([a, b, c]) > 0.0 && exact_normal(a, b, c) != Vec3::ZERO {
                // Rays would meet one of the two, and light be sampled on both: see `duplicate_emitters`.
                if shines.is_some_and(|two_sided| !self.shining.insert([a, b, c], two_sided)) {
                    duplicates += 1;
                    continue;
                }
                self.geometry.slivers |= is_sliver([a, b, c]);
                self.geometry.triangles.push(t);
                self.geometry.triangle_surface.push(index);
            }
        }
        let kept = before..self.geometry.triangles.len() as u32;
        let dropped = triangles.len() - kept.len() - duplicates;
        if duplicates > 0 {
            let plural = if duplicates == 1 { "triangle" } else { "triangles" };
            let message =
                format!("{duplicates} {plural} of a light, of {}, exactly where others are: left out", triangles.len());
            self.warn(surface, message);
        }
        if dropped > 0 {
            let plural = if dropped == 1 { "triangle" } else { "triangles" };
            self.warn(surface, format!("{dropped} {plural} without area dropped, of {}", triangles.len()));
        }
        kept
    }

    fn add_quadric(
        &mut self,
        surface: &SurfaceDesc,
        kind: QuadricKind,
        to_render: &DAffine3,
        radius: f64,
        emit: Emission,
        index: u32,
    ) -> Option<AreaLight> {
        let unit_to_render = *to_render * DAffine3::from_scale(DVec3::splat(radius));
        let id = self.geometry.quadrics.len() as u32;
        self.geometry.quadrics.push(Quadric::new(kind, unit_to_render, surface.flip_normals));
        self.geometry.quadric_surface.push(index);
        (emit.radiance != Rgb::ZERO).then(|| AreaLight::from_quadric(&self.geometry, id, emit, index)).flatten()
    }

    fn add_infinite(&mut self, desc: &InfiniteLightDesc, ball: SceneBall) {
        let light = match &desc.kind {
            InfiniteLightKind::Directional { direction, irradiance } => {
                let toward = (-*direction).as_vec3a().normalize();
                Light::Directional(DirectionalLight { toward, irradiance: rgb(*irradiance), ball })
            }
            InfiniteLightKind::Constant { radiance } => {
                Light::Environment(EnvironmentLight { radiance: Environment::Constant(rgb(*radiance)), ball })
            }
            InfiniteLightKind::Image { size: [width, height], texels, transform } => {
                let texels = texels.iter().map(|t| Rgb::from_array(*t)).collect();
                let Some(map) = EnvironmentMap::new(*width, *height, texels, *transform) else {
                    self.warnings.push(Diagnostic {
                        at: desc.at.clone(),
                        message: "the image is all black: the light emits no power and is left out".into(),
                    });
                    return;
                };
                Light::Environment(EnvironmentLight { radiance: Environment::Map(Box::new(map)), ball })
            }
        };
        let power = light.power();
        if !power.is_finite() {
            self.errors.push(too_bright(&desc.at));
        } else if power.max_element() > 0.0 {
            self.lights.push(light);
        } else {
            let message = "the light emits no power: it is left out".into();
            self.warnings.push(Diagnostic { at: desc.at.clone(), message });
        }
    }

    fn add_delta(&mut self, surface: &SurfaceDesc, material: &MaterialKind, to_render: &DAffine3) {
        let position = to_render.translation.as_vec3a();
        let to_intensity = self.scale * self.scale;
        let scaled = |c: [f64; 3]| rgb(c.map(|x| x * to_intensity));
        let light = match *material {
            MaterialKind::PointLight { intensity } => {
                Light::Point(PointLight { place: DeltaPlace::free(position), intensity: scaled(intensity) })
            }
            MaterialKind::SpotLight { intensity, inner_angle, outer_angle, profile } => {
                let axis = (to_render.matrix3 * -DVec3::Z).normalize().as_vec3a();
                let profile = match profile {
                    SpotProfile::Cosine { falloff } => Profile::Cosine { falloff },
                    SpotProfile::Angle => Profile::Angle,
                };
                let cone = Cone { inner: inner_angle, outer: outer_angle, profile };
                Light::Spot(SpotLight::new(position, axis, scaled(intensity), cone))
            }
            // The importer lets only lights stand on delta points.
            _ => return,
        };
        self.geometry.delta_points.push(DeltaPoint::new(position, 1.0));
        let power = light.power();
        if !power.is_finite() {
            self.errors.push(too_bright(&surface.at));
        } else if power.max_element() > 0.0 {
            self.delta_lights.push((self.lights.len(), surface.at.clone()));
            self.lights.push(light);
        } else {
            self.warn(surface, "the light emits no power: it is left out".into());
        }
    }
}

/// The ball around all that light can fall on.
fn ball(geometry: &Geometry) -> SceneBall {
    let corners = geometry.triangles.iter().flatten().map(|&i| geometry.positions[i as usize]);
    let quadrics = geometry.quadrics.iter().flat_map(|q| <[Vec3; 2]>::from(q.bounds()));
    let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in corners.chain(quadrics) {
        lo = lo.min(p);
        hi = hi.max(p);
    }
    if lo.x > hi.x { SceneBall::around(Vec3::ZERO, Vec3::ZERO) } else { SceneBall::around(lo, hi) }
}

/// The power of a light is its radiance times its area, or its intensity times its solid angle; it has to fit an f32.
fn too_bright(at: &Place) -> Diagnostic {
    Diagnostic {
        at: at.clone(),
        message: "the light is too bright: its power exceeds 3e38 in render space (the scene scaled to about unit \
                  size); lower its emission"
            .into(),
    }
}
