//! What other renderers and formats call things: a hint for whoever comes from one.
//!
//! Keys and types share one table, because a hint is only given where the word it leads to is allowed.

/// Words of others, in lower case and without `_`, `-` and spaces, and ours for them; where several are allowed, the first.
const SYNONYMS: &[(&str, &[&str])] = &[
    // Parts of a scene.
    ("bsdfs", &["materials"]),
    ("emitter", &["lights"]),
    ("emitters", &["lights"]),
    ("environment", &["background"]),
    ("geometry", &["surfaces"]),
    ("images", &["textures"]),
    ("light", &["lights"]),
    ("meshes", &["surfaces"]),
    ("objects", &["surfaces"]),
    ("primitives", &["surfaces"]),
    ("renderer", &["integrator"]),
    ("samplecount", &["samples", "image_samples"]),
    ("samples", &["image_samples"]),
    ("samplesperpixel", &["samples", "image_samples"]),
    ("sensor", &["camera"]),
    ("shapes", &["surfaces"]),
    ("sky", &["background"]),
    ("spp", &["samples", "image_samples"]),
    // Camera and transforms.
    ("aperturesize", &["aperture"]),
    ("apertureradius", &["aperture"]),
    ("eye", &["from"]),
    ("film", &["resolution"]),
    ("focaldistance", &["fdist"]),
    ("focusdistance", &["fdist"]),
    ("fieldofview", &["vfov"]),
    ("fov", &["vfov"]),
    ("fovy", &["vfov"]),
    ("imagesize", &["resolution"]),
    ("lensradius", &["aperture"]),
    ("lookat", &["transform", "at"]),
    ("lookfrom", &["from"]),
    ("matrix", &["transform"]),
    ("orientation", &["rotate", "transform"]),
    ("origin", &["from", "o", "position"]),
    ("position", &["from", "translate", "transform"]),
    ("projection", &["type"]),
    ("reconstructionfilter", &["filter"]),
    ("rfilter", &["filter"]),
    ("rotation", &["rotate", "transform"]),
    ("scaling", &["scale"]),
    ("size", &["resolution"]),
    ("target", &["at"]),
    ("toworld", &["transform"]),
    ("translation", &["translate", "transform"]),
    ("vup", &["up"]),
    ("yfov", &["vfov"]),
    // Integrator and sampler.
    ("bounces", &["max_bounces"]),
    ("depth", &["max_bounces"]),
    ("maxdepth", &["max_bounces"]),
    ("mis", &["heuristic"]),
    ("roulette", &["russian_roulette"]),
    ("rr", &["russian_roulette"]),
    // Surfaces.
    ("alpha", &["roughness", "opacity"]),
    ("alphamask", &["opacity"]),
    ("bsdf", &["material"]),
    ("bump", &["bump_map"]),
    ("faces", &["indices"]),
    ("file", &["filename"]),
    ("flip", &["flip_normals"]),
    ("invertnormals", &["flip_normals"]),
    ("mat", &["material"]),
    ("model", &["filename"]),
    ("normalmap", &["normal_map"]),
    ("path", &["filename"]),
    ("points", &["positions"]),
    ("reverseorientation", &["flip_normals"]),
    ("shader", &["material"]),
    ("st", &["uvs"]),
    ("texcoords", &["uvs"]),
    ("triangles", &["indices"]),
    ("uv", &["uvs"]),
    ("vertices", &["positions"]),
    ("verts", &["positions"]),
    // Materials and lights.
    ("basecolor", &["albedo"]),
    ("beamwidth", &["inner_angle"]),
    ("brightness", &["emit", "intensity", "irradiance", "radiance"]),
    ("color", &["albedo", "emit", "intensity", "irradiance", "radiance"]),
    ("colour", &["color", "albedo", "emit", "intensity", "irradiance", "radiance"]),
    ("conetotalwidth", &["outer_angle"]),
    ("cutoffangle", &["outer_angle"]),
    ("diffuse", &["albedo", "lambertian"]),
    ("diffusereflectance", &["albedo"]),
    ("emission", &["emit", "intensity", "radiance"]),
    ("emissive", &["emit", "diffuse light"]),
    ("emittance", &["emit"]),
    ("eta", &["ior"]),
    ("extior", &["ior"]),
    ("indexofrefraction", &["ior"]),
    ("intior", &["ior"]),
    ("intensity", &["emit", "irradiance", "radiance"]),
    ("kd", &["albedo"]),
    ("le", &["emit"]),
    ("power", &["exponent"]),
    ("radiance", &["emit", "intensity", "irradiance"]),
    ("reflectance", &["albedo"]),
    ("refractiveindex", &["ior"]),
    ("shininess", &["exponent"]),
    ("specularreflectance", &["albedo"]),
    ("speculartransmittance", &["transmittance"]),
    ("twosided", &["two_sided"]),
    ("weight", &["amount"]),
    // Textures.
    ("color0", &["even", "base"]),
    ("color1", &["odd", "veins"]),
    ("tex1", &["even"]),
    ("tex2", &["odd"]),
    ("url", &["filename"]),
    ("value", &["color"]),
    // Types.
    ("area", &["diffuse light"]),
    ("arealight", &["diffuse light"]),
    ("bitmap", &["image"]),
    ("checkerboard", &["checker"]),
    ("circle", &["disk"]),
    ("constantcolor", &["constant"]),
    ("distant", &["directional"]),
    ("envmap", &["environment"]),
    ("glass", &["dielectric"]),
    ("imagemap", &["image"]),
    ("infinite", &["environment"]),
    ("matte", &["lambertian"]),
    ("obj", &["mesh"]),
    ("ortho", &["orthographic"]),
    ("pathtracer", &["path"]),
    ("pinhole", &["perspective"]),
    ("plane", &["quad"]),
    ("ply", &["mesh"]),
    ("pt", &["path"]),
    ("random", &["independent"]),
    ("rectangle", &["quad"]),
    ("roughconductor", &["conductor"]),
    ("roughdielectric", &["dielectric"]),
    ("roughplastic", &["plastic"]),
    ("spotlight", &["spot"]),
    ("sun", &["directional"]),
    ("thindielectric", &["thin dielectric"]),
    ("thinlens", &["perspective"]),
    ("trianglemesh", &["mesh"]),
    ("pointlight", &["point"]),
];

/// What a word of another renderer is called here, among the candidates.
pub(super) fn translated<'c, S: AsRef<str>>(word: &str, candidates: &'c [S]) -> Option<&'c str> {
    let plain: String = word.chars().filter(|c| !"_- ".contains(*c)).flat_map(char::to_lowercase).collect();
    let ours = SYNONYMS.iter().filter(|(theirs, _)| *theirs == plain).flat_map(|(_, ours)| *ours);
    ours.copied().find_map(|our| candidates.iter().map(AsRef::as_ref).find(|c| *c == our))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_others_are_known_where_ours_are_allowed() {
        let keys = ["albedo", "emit", "type"];
        for (word, ours) in
            [("diffuse", Some("albedo")), ("Base_Color", Some("albedo")), ("emission", Some("emit")), ("mat", None)]
        {
            assert_eq!(translated(word, &keys), ours, "{word}");
        }
        assert_eq!(translated("color", &["emit", "two_sided"]), Some("emit"));
        assert_eq!(translated("diffuse", &["mirror", "lambertian"]), Some("lambertian"));
    }

    #[test]
    fn the_table_is_written_as_it_is_looked_up() {
        for (i, (theirs, ours)) in SYNONYMS.iter().enumerate() {
            let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
            assert!(theirs.chars().all(plain) && !ours.is_empty(), "{theirs}");
            assert!(SYNONYMS[..i].iter().all(|(other, _)| other != theirs), "{theirs} twice");
        }
    }
}
