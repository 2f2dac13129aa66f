//! Messages to the surroundings, and the clock.
//!
//! A message is made into a plain object by serde-wasm-bindgen: maps as objects, absent values as null, 64-bit counts as
//! numbers (exact up to 2^53, which no count here reaches). Bytes go as `Uint8Array`s of their own. The last post function
//! is kept aside for the panic hook, which has no engine at hand.

use std::cell::RefCell;

use js_sys::{Function, Object, Reflect, Uint8Array};
use serde::Serialize;
use wasm_bindgen::{JsCast, JsValue};

use crate::protocol::Message;

thread_local! {
    static LAST: RefCell<Option<Post>> = const { RefCell::new(None) };
}

/// Where messages go.
#[derive(Clone)]
pub struct Post(Function);

impl Post {
    /// Posts through `function`; a panic from now on is posted there, too.
    pub fn new(function: Function) -> Post {
        let post = Post(function);
        LAST.with(|last| *last.borrow_mut() = Some(post.clone()));
        std::panic::set_hook(Box::new(|info| {
            let place = info.location().map_or(String::new(), |l| format!(" ({}:{})", l.file(), l.line()));
            let text = info.payload();
            let text =
                text.downcast_ref::<&str>().copied().or_else(|| text.downcast_ref::<String>().map(String::as_str));
            let message = format!("{}{place}", text.unwrap_or("it met something it did not expect"));
            // A panic within a call to the page would find the cell borrowed; there is nobody to tell then.
            LAST.with(|last| {
                if let Ok(last) = last.try_borrow()
                    && let Some(post) = &*last
                {
                    post.send(&Message::Fault { message, kind: "trap" });
                }
            });
        }));
        post
    }

    /// Posts a message.
    pub fn send(&self, message: &impl Serialize) {
        let serializer =
            serde_wasm_bindgen::Serializer::json_compatible().serialize_large_number_types_as_bigints(false);
        if let Ok(value) = message.serialize(&serializer) {
            self.raw(&value);
        }
    }

    /// Posts an object with bytes: `{type, [names and values], bytes}`.
    pub fn bytes(&self, kind: &str, fields: &[(&str, JsValue)], bytes: &[u8]) {
        let object = Object::new();
        let set = |name: &str, value: &JsValue| {
            // Setting a property of a fresh plain object cannot fail.
            let _ = Reflect::set(&object, &name.into(), value);
        };
        set("type", &kind.into());
        for (name, value) in fields {
            set(name, value);
        }
        set("bytes", &Uint8Array::from(bytes));
        self.raw(&object);
    }

    fn raw(&self, value: &JsValue) {
        // What the page does with a message is its own affair.
        let _ = self.0.call1(&JsValue::NULL, value);
    }
}

/// Milliseconds since the worker or page began.
#[derive(Clone)]
pub struct Clock(Option<web_sys::Performance>);

impl Clock {
    /// The clock of a worker or a page.
    pub fn new() -> Clock {
        let performance = Reflect::get(&js_sys::global(), &"performance".into());
        Clock(performance.ok().and_then(|p| p.dyn_into().ok()))
    }

    /// Now.
    pub fn now(&self) -> f64 {
        self.0.as_ref().map_or_else(js_sys::Date::now, |p| p.now())
    }
}
