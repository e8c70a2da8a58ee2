//! Parameters: one table of definitions drives declaration, checks, `--help`, `config/default.yaml` and the services.

mod services;
mod table;
mod values;

pub use services::{Change, ParameterServers, Setter, declare};
pub use table::{Definition, Range, When, default_yaml, help, table};
pub use values::Values;

use ros2_client::ParameterValue;

/// A value as YAML would write it.
pub fn show(value: &ParameterValue) -> String {
    fn list<T>(items: &[T], each: impl Fn(&T) -> String) -> String {
        format!("[{}]", items.iter().map(each).collect::<Vec<_>>().join(", "))
    }
    match value {
        ParameterValue::NotSet => "not set".into(),
        ParameterValue::Boolean(b) => b.to_string(),
        ParameterValue::Integer(i) => i.to_string(),
        ParameterValue::Double(d) => format!("{d:?}"),
        ParameterValue::String(s) if s.is_empty() => "''".into(),
        ParameterValue::String(s) => s.clone(),
        ParameterValue::ByteArray(a) => list(a, u8::to_string),
        ParameterValue::BooleanArray(a) => list(a, bool::to_string),
        ParameterValue::IntegerArray(a) => list(a, i64::to_string),
        ParameterValue::DoubleArray(a) => list(a, |d| format!("{d:?}")),
        ParameterValue::StringArray(a) => list(a, String::clone),
    }
}

/// The ROS name of a value's type.
pub fn type_name(value: &ParameterValue) -> &'static str {
    match value {
        ParameterValue::NotSet => "not set",
        ParameterValue::Boolean(_) => "bool",
        ParameterValue::Integer(_) => "integer",
        ParameterValue::Double(_) => "double",
        ParameterValue::String(_) => "string",
        ParameterValue::ByteArray(_) => "byte array",
        ParameterValue::BooleanArray(_) => "bool array",
        ParameterValue::IntegerArray(_) => "integer array",
        ParameterValue::DoubleArray(_) => "double array",
        ParameterValue::StringArray(_) => "string array",
    }
}
