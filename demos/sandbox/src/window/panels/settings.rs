//! Controls of all settings, generated from their JSON schema with ranges and descriptions.

use eframe::egui::{CollapsingHeader, ComboBox, DragValue, Response, Slider, SliderClamping, Ui};
use lamplight::{Bounces, Display, Method, Scene, Settings, ToneMap};
use serde_json::{Value, json};

/// The smallest range of a logarithmic slider.
const WIDE: f64 = 100.0;

/// The panel of settings.
pub struct Panel {
    schema: Value,
    /// The error of invalid settings.
    error: Option<String>,
}

impl Panel {
    pub fn new() -> Self {
        Self { schema: serde_json::to_value(Scene::schema()).unwrap_or_default(), error: None }
    }

    /// Shows a choice of methods; returns the chosen one.
    pub fn method(&self, ui: &mut Ui, current: Method) -> Method {
        let mut chosen = current;
        ui.horizontal(|ui| {
            ui.label("Method");
            ComboBox::from_id_salt("method").selected_text(current.name()).show_ui(ui, |ui| {
                for &method in Method::ALL {
                    let label = ui.selectable_value(&mut chosen, method, method.name());
                    self.explain(label, "Method", method.name());
                }
            });
        });
        chosen
    }

    /// Shows the presets and settings of the method, and the settings that all methods share.
    pub fn show(&mut self, ui: &mut Ui, settings: &mut Settings) {
        preset(ui, settings);
        let Ok(mut values) = serde_json::to_value(&*settings) else { return };
        let before = values.clone();
        let name = settings.method().name();
        CollapsingHeader::new(format!("Settings of {name}")).default_open(true).show(ui, |ui| {
            self.table(ui, name, &mut values[name]);
        });
        CollapsingHeader::new("Light").default_open(true).show(ui, |ui| {
            let mut wanted = settings.bounces;
            bounces(ui, &mut wanted);
            values["bounces"] = wanted.into();
            self.keys(ui, "Settings", &mut values, &["wall_depth", "seed"]);
        });
        if settings.method() == Method::Raymarch {
            for (title, key) in [("Mean over frames", "temporal"), ("Denoise", "denoise")] {
                CollapsingHeader::new(title).show(ui, |ui| {
                    self.table(ui, key, &mut values[key]);
                });
            }
        }
        if values != before {
            let changed: Result<Settings, _> = serde_json::from_value(values);
            let checked = changed.map_err(|e| e.to_string());
            let checked = checked.and_then(|s| s.check().map(|()| s).map_err(|e| e.to_string()));
            match checked {
                Ok(changed) => {
                    *settings = changed;
                    self.error = None;
                }
                Err(why) => self.error = Some(why),
            }
        }
        if let Some(why) = &self.error {
            ui.colored_label(ui.visuals().warn_fg_color, why);
        }
    }

    fn properties(&self, type_name: &str) -> Option<&serde_json::Map<String, Value>> {
        self.schema["$defs"][type_name]["properties"].as_object()
    }

    /// Shows all settings of a table.
    fn table(&self, ui: &mut Ui, table: &str, values: &mut Value) {
        let type_name = type_name(table);
        let Some(properties) = self.properties(&type_name) else { return };
        let keys: Vec<&str> = properties.keys().map(String::as_str).collect();
        self.keys(ui, &type_name, values, &keys);
    }

    /// Shows some settings of a table.
    fn keys(&self, ui: &mut Ui, type_name: &str, values: &mut Value, keys: &[&str]) {
        let Some(properties) = self.properties(type_name) else { return };
        for &key in keys {
            let Some(property) = properties.get(key) else { continue };
            if let Some(value) = values.get_mut(key) {
                let response = self.edit(ui, key, property, value);
                response.on_hover_text(property["description"].as_str().unwrap_or_default());
            }
        }
    }

    /// Shows one setting.
    fn edit(&self, ui: &mut Ui, key: &str, property: &Value, value: &mut Value) -> Response {
        let label = key.replace('_', " ");
        if let Some(mut on) = value.as_bool() {
            let response = ui.checkbox(&mut on, label);
            *value = json!(on);
            return response;
        }
        let choices = self.choices(property);
        if !choices.is_empty() {
            return ui
                .horizontal(|ui| {
                    ui.label(&label);
                    ComboBox::from_id_salt(key).selected_text(text(value)).show_ui(ui, |ui| {
                        for (choice, words) in choices {
                            let label = text(&choice);
                            let response = ui.selectable_value(value, choice, label);
                            response.on_hover_text(words);
                        }
                    });
                })
                .response;
        }
        let bounds = ["minimum", "maximum"].map(|bound| property[bound].as_f64());
        let whole = property["type"] == "integer";
        match (value.as_f64(), bounds) {
            (Some(mut number), [Some(low), Some(high)]) => {
                let slider = Slider::new(&mut number, low..=high)
                    .text(label)
                    .logarithmic(high - low > WIDE)
                    .smallest_positive(if whole { 1.0 } else { 1e-3 });
                let response = ui.add(if whole { slider.integer() } else { slider });
                *value = if whole { json!(number.round() as u64) } else { json!(number as f32) };
                response
            }
            (Some(_), _) => {
                let mut number = value.as_u64().unwrap_or_default();
                let response =
                    ui.horizontal(|ui| ui.add(DragValue::new(&mut number)) | ui.label(label)).inner;
                *value = json!(number);
                response
            }
            (None, _) => ui.label(label),
        }
    }

    /// The values of a setting with their descriptions; empty if it is not an enumeration.
    fn choices(&self, property: &Value) -> Vec<(Value, String)> {
        if let Some(values) = property["enum"].as_array() {
            return values.iter().map(|value| (value.clone(), String::new())).collect();
        }
        let Some(name) = property["$ref"].as_str().and_then(|path| path.rsplit('/').next()) else {
            return Vec::new();
        };
        let definition = &self.schema["$defs"][name];
        let words = |of: &Value| of["description"].as_str().unwrap_or_default().to_owned();
        match definition["oneOf"].as_array() {
            Some(all) => all.iter().map(|one| (one["const"].clone(), words(one))).collect(),
            None => self.choices(definition),
        }
    }

    /// Describes a choice in a tooltip.
    fn explain(&self, response: Response, type_name: &str, name: &str) {
        let property = json!({ "$ref": format!("#/$defs/{type_name}") });
        if let Some((_, words)) =
            self.choices(&property).into_iter().find(|(value, _)| value == name)
        {
            response.on_hover_text(words);
        }
    }
}

/// The type of a table in the schema: `Raymarch` for `raymarch`.
fn type_name(table: &str) -> String {
    table[..1].to_uppercase() + &table[1..]
}

fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), |word| word.replace('_', " "))
}

/// Shows the presets of the method.
fn preset(ui: &mut Ui, settings: &mut Settings) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Preset");
        for &name in settings.method().presets() {
            let mut wanted = settings.clone();
            let known = wanted.set_preset(name).is_ok();
            if known && ui.selectable_label(wanted == *settings, name).clicked() {
                *settings = wanted;
            }
        }
    });
}

/// Shows the bounces: over frames, or within each.
fn bounces(ui: &mut Ui, bounces: &mut Bounces) {
    let mut count = match *bounces {
        Bounces::Count(count) => count,
        Bounces::Converged | Bounces::Feedback => 2,
    };
    ui.horizontal(|ui| {
        ui.label("bounces");
        ui.selectable_value(bounces, Bounces::Feedback, "over frames")
            .on_hover_text("One more in each frame, at the price of none.");
        ui.selectable_value(bounces, Bounces::Converged, "all")
            .on_hover_text("In each frame, until the largest change is under 0.1 % of the mean.");
        let counted = matches!(bounces, Bounces::Count(_));
        if ui.selectable_label(counted, "some").on_hover_text("In each frame.").clicked() {
            *bounces = Bounces::Count(count);
        }
    });
    if matches!(bounces, Bounces::Count(_)) {
        let slider = Slider::new(&mut count, 0..=8).clamping(SliderClamping::Never);
        ui.add(slider.text("bounces")).on_hover_text("Each one costs another gather.");
        *bounces = Bounces::Count(count.min(Bounces::MAX));
    }
}

/// Shows tone map and exposure.
pub fn display(ui: &mut Ui, display: &mut Display) {
    ui.horizontal(|ui| {
        for &map in ToneMap::ALL {
            ui.selectable_value(&mut display.tonemap, map, map.name());
        }
    });
    // Scenes may have more.
    let slider = Slider::new(&mut display.exposure, -8.0..=8.0).clamping(SliderClamping::Edits);
    ui.add(slider.text("exposure, stops"));
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, RawInput};

    const BOUNCES: [Bounces; 4] =
        [Bounces::Count(0), Bounces::Count(200), Bounces::Converged, Bounces::Feedback];

    #[test]
    fn showing_settings_does_not_change_them() {
        let mut panel = Panel::new();
        for &method in Method::ALL {
            for &preset in method.presets() {
                let mut settings = Settings { wall_depth: 2.5, ..Settings::new(method) };
                settings.set_preset(preset).unwrap();
                for bounces in BOUNCES {
                    settings.bounces = bounces;
                    let mut seen = settings.clone();
                    // If nothing were shown, settings would not change either.
                    let mut shown = Context::default().run_ui(RawInput::default(), |ui| {
                        panel.show(ui, &mut seen);
                    });
                    // No renderer takes the font's texture: egui panics on deltas dropped in silence.
                    shown.textures_delta.clear();
                    assert_eq!(seen, settings, "{preset}");
                    assert!(shown.shapes.len() > 20, "{} shapes", shown.shapes.len());
                    assert_eq!(panel.error, None);
                }
            }
        }
    }

    #[test]
    fn showing_an_exposure_beyond_the_slider_does_not_change_it() {
        for exposure in [-20.0, 0.3, 12.5] {
            let wanted = Display { exposure, ..Display::default() };
            let mut seen = wanted;
            let mut shown = Context::default().run_ui(RawInput::default(), |ui| {
                display(ui, &mut seen);
            });
            // No renderer takes the font's texture: egui panics on deltas dropped in silence.
            shown.textures_delta.clear();
            assert_eq!(seen, wanted);
        }
    }

    #[test]
    fn every_setting_of_every_method_has_a_control() {
        let panel = Panel::new();
        for &method in Method::ALL {
            let defaults = serde_json::to_value(Settings::new(method)).unwrap();
            let name = method.name();
            let properties = panel.properties(&type_name(name)).unwrap();
            for (key, value) in defaults[name].as_object().unwrap() {
                let property = &properties[key];
                let number = property["minimum"].is_number() && property["maximum"].is_number();
                let choice = !panel.choices(property).is_empty();
                assert!(value.is_boolean() || number || choice, "{name}.{key}: {property}");
            }
        }
    }
}
