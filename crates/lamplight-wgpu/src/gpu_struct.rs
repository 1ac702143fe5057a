//! Structs that shaders read, declared once.

/// The layout of a struct, for tests that compare it with a shader's.
#[cfg(test)]
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    pub name: &'static str,
    /// Names and offsets.
    pub fields: &'a [(&'static str, usize)],
    pub size: usize,
}

/// Declares a struct of the same name and layout as one of a shader's. Fields whose name begins with `padding`
/// are not in the shader.
macro_rules! gpu_struct {
    (
        $(#[$meta:meta])*
        pub struct $name:ident { $($(#[$note:meta])* $vis:vis $field:ident: $type:ty,)* }
    ) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$note])* $vis $field: $type,)* }

        #[cfg(test)]
        impl $name {
            /// The layout, which a test compares with the shader's.
            pub const LAYOUT: crate::gpu_struct::Layout<'static> = crate::gpu_struct::Layout {
                name: stringify!($name),
                fields: &[$((stringify!($field), std::mem::offset_of!($name, $field))),*],
                size: size_of::<$name>(),
            };
        }
    };
}
pub(crate) use gpu_struct;
