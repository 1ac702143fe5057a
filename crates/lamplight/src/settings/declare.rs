//! `settings!`: a table of settings with each name, default, range and description written once.

/// Declares a struct of settings.
///
/// Each field has a description, a type, a default and, if it is a number, a closed range. From
/// this one line come the field, its documentation, the default, the JSON Schema that editors
/// and the sandbox read, and the check with its error message.
///
/// `check` holds the rules that a range cannot express; it may be left out.
macro_rules! settings {
    (
        $(#[$meta:meta])*
        pub struct $name:ident in $table:literal {
            $(
                $(#[$field_meta:meta])*
                $field:ident: $type:ty = $default:expr $(, in $least:literal..=$most:literal)?;
            )*
        }
        $(check $extra:expr)?
    ) => {
        #[derive(Clone, Debug, PartialEq)]
        #[derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
        #[serde(default, deny_unknown_fields)]
        $(#[$meta])*
        pub struct $name {
            $(
                $(#[$field_meta])*
                $(
                    #[doc = concat!("\n\nFrom ", $least, " to ", $most, ".")]
                    #[schemars(range(min = $least, max = $most))]
                )?
                pub $field: $type,
            )*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default),* }
            }
        }

        impl $name {
            /// Rejects values out of their range.
            pub(super) fn check(&self) -> $crate::Result<()> {
                $($(
                    let key = concat!($table, ".", stringify!($field));
                    super::range::within(key, self.$field, $least..=$most)?;
                )?)*
                $(($extra as fn(&Self) -> $crate::Result<()>)(self)?;)?
                Ok(())
            }
        }
    };
}

pub(super) use settings;
