// Rays as they come to the shader.

// core/src/ray.rs: CanonicalRay, without its clock. Limits of t' are finite here.
struct CanonicalRay {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
}
