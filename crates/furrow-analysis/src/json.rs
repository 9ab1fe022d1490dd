//! Objects of JSON put together.

use serde_json::Value;

/// An object without its fields that are null.
pub fn filled(mut object: Value) -> Value {
    object.as_object_mut().into_iter().for_each(|fields| fields.retain(|_, value| !value.is_null()));
    object
}

/// An object with the fields of another behind its own.
pub fn merged(mut object: Value, other: Value) -> Value {
    if let (Some(fields), Value::Object(other)) = (object.as_object_mut(), other) {
        fields.extend(other);
    }
    object
}
