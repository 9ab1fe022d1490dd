//! Laws stated in Rust, as one generic function.
//!
//! The function is called once, with symbols instead of numbers. Its operations are recorded as expressions, so
//! the law is cached, saved and differentiated like one from a file.

use std::cell::{Cell as Flag, RefCell};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::file::Document;
use super::program::{Algebra, Function};
use super::text::LONGEST;
use super::{Active, Constant, Law};
use furrow_input::InputError;

/// A law of active stress as a function that is generic over the number type.
///
/// ```
/// use furrow_cell::law::{Active, Algebra, Law, Stated};
///
/// /// Isotropic tension that falls where the cortex bends.
/// struct Falling;
///
/// impl Stated for Falling {
///     fn name(&self) -> &str {
///         "falling"
///     }
///     fn constants(&self) -> Vec<(&str, f64)> {
///         vec![("half", 4.0)]
///     }
///     fn active<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> Active<N> {
///         let tension = at("gain") * at("xi_s") / (N::from(1.0) + (at("C") / at("half")).whole_power(2));
///         Active { stress: [tension, tension], moment: N::from(0.0), normal_force: N::from(0.0) }
///     }
/// }
///
/// let text = r#"Law(
///     name: "falling",
///     constants: { "half": (value: 4.0) },
///     stress_uu: "((gain * xi_s) / (1 + ((C / half) ^ 2)))",
///     stress_phiphi: "((gain * xi_s) / (1 + ((C / half) ^ 2)))",
/// )"#;
/// assert_eq!(Law::stated(&Falling)?, Law::parse(text, "falling.ron")?);
/// # Ok::<(), furrow_input::InputError>(())
/// ```
pub trait Stated {
    /// Its name in messages and reports.
    fn name(&self) -> &str;

    /// Its constants, in units of κ0, L_h and τ; the parameters `law.NAME` change them.
    fn constants(&self) -> Vec<(&str, f64)> {
        Vec::new()
    }

    /// Stresses in κ0/L_h², moment in κ0/L_h and force in κ0/L_h³; the number 0 means no moment or no force. `at` returns a quantity by
    /// its name in files: a [`Variable`](super::Variable), a parameter, or a constant. The function must not inspect the value of a
    /// number ([`Algebra::real`]); [`Algebra::least`] and [`Algebra::most`] choose between numbers.
    fn active<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> Active<N>;
}

/// The recorded operations of a function.
#[derive(Default)]
struct Record {
    texts: RefCell<Vec<String>>,
    /// Whether the function inspected the value of a number.
    looked: Flag<bool>,
}

/// A number, or the index of an expression in a record.
#[derive(Clone, Copy)]
enum Symbol<'a> {
    Number(f64),
    Written(&'a Record, usize),
}

impl<'a> Symbol<'a> {
    fn text(self) -> String {
        match self {
            Symbol::Number(x) if x < 0.0 => format!("({})", written(x)),
            Symbol::Number(x) => written(x),
            Symbol::Written(record, at) => record.texts.borrow().get(at).cloned().unwrap_or_default(),
        }
    }

    /// Adds a text to the record of the first operand that has one.
    fn write(of: [Symbol<'a>; 2], text: String) -> Symbol<'a> {
        let record = of.into_iter().find_map(|x| if let Symbol::Written(record, _) = x { Some(record) } else { None });
        let Some(record) = record else { return Symbol::Number(f64::NAN) };
        let mut texts = record.texts.borrow_mut();
        // A longer text is rejected when it is parsed, so it need not be recorded further.
        texts.push(if text.len() > 2 * LONGEST { "0".repeat(LONGEST + 1) } else { text });
        Symbol::Written(record, texts.len() - 1)
    }

    fn both(self, other: Symbol<'a>, sign: &str, of: fn(f64, f64) -> f64) -> Symbol<'a> {
        match (self, other) {
            (Symbol::Number(a), Symbol::Number(b)) => Symbol::Number(of(a, b)),
            _ => Symbol::write([self, other], format!("({} {sign} {})", self.text(), other.text())),
        }
    }
}

impl From<f64> for Symbol<'_> {
    fn from(x: f64) -> Self {
        Symbol::Number(x)
    }
}

macro_rules! operator {
    ($of:ident, $method:ident, $sign:literal) => {
        impl $of for Symbol<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.both(other, $sign, |a, b| a.$method(b))
            }
        }
    };
}

operator!(Add, add, "+");
operator!(Sub, sub, "-");
operator!(Mul, mul, "*");
operator!(Div, div, "/");

impl Mul<f64> for Symbol<'_> {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        self * Symbol::Number(factor)
    }
}

impl Neg for Symbol<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            Symbol::Number(x) => Symbol::Number(-x),
            Symbol::Written(..) => Symbol::write([self; 2], format!("(-{})", self.text())),
        }
    }
}

impl Algebra for Symbol<'_> {
    fn real(self) -> f64 {
        match self {
            Symbol::Number(x) => x,
            Symbol::Written(record, _) => {
                record.looked.set(true);
                f64::NAN
            }
        }
    }

    fn call(self, function: Function) -> Self {
        let name = Function::ALL.into_iter().find(|(other, _)| *other == function).map_or("", |(_, name)| name);
        match self {
            Symbol::Number(x) => Symbol::Number(x.call(function)),
            Symbol::Written(..) => Symbol::write([self; 2], format!("{name}({})", self.text())),
        }
    }

    fn whole_power(self, exponent: i32) -> Self {
        match self {
            Symbol::Number(x) => Symbol::Number(x.powi(exponent)),
            Symbol::Written(..) if exponent < 0 => {
                Symbol::write([self; 2], format!("({} ^ ({exponent}))", self.text()))
            }
            Symbol::Written(..) => Symbol::write([self; 2], format!("({} ^ {exponent})", self.text())),
        }
    }

    fn least(self, other: Self) -> Self {
        Symbol::write([self, other], format!("min({}, {})", self.text(), other.text()))
    }

    fn most(self, other: Self) -> Self {
        Symbol::write([self, other], format!("max({}, {})", self.text(), other.text()))
    }
}

impl Law {
    /// The law defined by a function, which equals the law of a file with these expressions.
    ///
    /// # Errors
    /// Names the expression and the fault: an unknown name, a number that is not finite, too much text, too many operations, a comparison of
    /// numbers, or a condition of [`parse`](Self::parse).
    pub fn stated(law: &impl Stated) -> Result<Law, InputError> {
        let record = Record::default();
        let start = Symbol::Written(&record, 0);
        let Active { stress: [uu, phiphi], moment, normal_force } =
            law.active(&|name: &str| Symbol::write([start; 2], name.to_owned()));
        let file = format!("the law {:?}", law.name());
        if record.looked.get() {
            let message = "its function looks at the value of a number, which differs from place to place: \
                           least and most choose between numbers";
            return Err(InputError::Founders { file, message: message.to_owned() });
        }
        let some = |x: Symbol| if let Symbol::Number(0.0) = x { None } else { Some(x.text()) };
        let constant = |(name, value): (&str, f64)| (name.to_owned(), Constant { value, unit: None });
        let constants = law.constants().into_iter().map(constant).collect();
        let texts = [some(moment), Some(uu.text()), Some(phiphi.text()), some(normal_force)];
        Document::new(law.name(), constants, texts).checked("", &file)
    }
}

/// A number in the user's notation.
fn written(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e15 { x.to_string() } else { format!("{x:?}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function of the quantities that may do anything.
    struct Of<F>(F);

    /// The function of a test's law.
    trait Act {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2];
    }

    impl<F: Act> Stated for Of<F> {
        fn name(&self) -> &str {
            "test"
        }
        fn constants(&self) -> Vec<(&str, f64)> {
            vec![("k", 2.5)]
        }
        fn active<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> Active<N> {
            let [tension, moment] = self.0.act(at);
            Active { stress: [tension, tension], moment, normal_force: N::from(0.0) }
        }
    }

    /// Every operation once.
    struct Everything;
    impl Act for Everything {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2] {
            let functions =
                Function::ALL.into_iter().map(|(function, _)| (at("C") * 0.1 + N::from(1.5)).call(function));
            let sum = functions.fold(-at("k"), |sum, x| sum + x);
            let chosen =
                at("u").least(N::from(0.5)).most(N::from(-0.25)) - (at("r") + N::from(0.5)).whole_power(-2) / at("r0");
            [at("xi_s") * (sum + chosen * N::from(2.0).call(Function::Sqrt)), at("kappa") * -0.3]
        }
    }

    #[test]
    fn a_function_gives_the_numbers_of_its_text() {
        let law = Law::stated(&Of(Everything)).unwrap();
        let text = r#"Law(name: "test", constants: {"k": (value: 2.5)},
            stress_uu: "xi_s*(-k + sqrt(C*0.1 + 1.5) + exp(C*0.1 + 1.5) + ln(C*0.1 + 1.5) + sin(C*0.1 + 1.5) + cos(C*0.1 + 1.5) + tan(C*0.1 + 1.5) + sinh(C*0.1 + 1.5) + cosh(C*0.1 + 1.5) + tanh(C*0.1 + 1.5) + atan(C*0.1 + 1.5) + abs(C*0.1 + 1.5) + (max(min(u, 0.5), -0.25) - (r + 0.5)^(-2)/r0)*sqrt(2))",
            stress_phiphi: "xi_s*(-k + sqrt(C*0.1 + 1.5) + exp(C*0.1 + 1.5) + ln(C*0.1 + 1.5) + sin(C*0.1 + 1.5) + cos(C*0.1 + 1.5) + tan(C*0.1 + 1.5) + sinh(C*0.1 + 1.5) + cosh(C*0.1 + 1.5) + tanh(C*0.1 + 1.5) + atan(C*0.1 + 1.5) + abs(C*0.1 + 1.5) + (max(min(u, 0.5), -0.25) - (r + 0.5)^(-2)/r0)*sqrt(2))",
            moment: "kappa*-0.3")"#;
        let written = Law::parse(text, "test.ron").unwrap();
        let (cell, mut memory) = (crate::Cell::new(2.0), Vec::new());
        let place = std::array::from_fn(|k| 0.3 + 0.1 * k as f64);
        let [a, b] =
            [&law, &written].map(|law| super::super::LawValues::new(law, &cell, |_, x| x).at(&place, &mut memory));
        assert_eq!(a, b);
        assert!(a.moment < 0.0 && law.constants().count() == 1);
    }

    struct Looks;
    impl Act for Looks {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2] {
            let c = at("C");
            [at("xi_s") * if c.real() > 1.0 { c } else { -c }, N::from(0.0)]
        }
    }

    struct Unknown;
    impl Act for Unknown {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2] {
            [at("xi_s") * at("kapa"), N::from(0.0)]
        }
    }

    struct Endless;
    impl Act for Endless {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2] {
            [(0..60).fold(at("xi_s"), |x, _| x * x), N::from(0.0)]
        }
    }

    struct Infinite;
    impl Act for Infinite {
        fn act<N: Algebra>(&self, at: &dyn Fn(&str) -> N) -> [N; 2] {
            [at("xi_s") * f64::INFINITY, N::from(0.0)]
        }
    }

    #[test]
    fn a_function_that_is_no_law_is_refused_with_its_name() {
        let refused = |law: Result<Law, InputError>, part: &str| {
            let error = law.unwrap_err().to_string();
            assert!(error.contains("\"test\"") && error.contains(part), "{error}");
        };
        refused(Law::stated(&Of(Looks)), "least and most");
        refused(Law::stated(&Of(Unknown)), "unknown name \"kapa\"");
        refused(Law::stated(&Of(Endless)), "4096");
        refused(Law::stated(&Of(Infinite)), "inf");
    }
}
