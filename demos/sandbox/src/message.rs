//! Error messages for users.

/// The chain of causes of an error. Causes whose text an earlier one contains are left out.
pub fn message(why: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in why.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            text += if text.is_empty() { "" } else { ": " };
            text += &cause;
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_not_repeated() {
        let plain = anyhow::anyhow!("no such file")
            .context("cannot read a.png")
            .context("layer: cannot read a.png");
        assert_eq!(message(&plain), "layer: cannot read a.png: no such file");
    }
}
