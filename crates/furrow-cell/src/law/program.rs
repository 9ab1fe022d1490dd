//! Expressions as a list of operations that can be evaluated for any number type.
//!
//! Common subexpressions of a law are computed once. Derivatives follow from running the same list with
//! numbers that carry derivatives.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::Number;

/// A function of one variable that expressions may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Arc tangent.
    Atan,
    /// Absolute value.
    Abs,
}

impl Function {
    /// Every function, with its name.
    pub const ALL: [(Function, &'static str); 11] = {
        use Function::*;
        [
            (Sqrt, "sqrt"),
            (Exp, "exp"),
            (Ln, "ln"),
            (Sin, "sin"),
            (Cos, "cos"),
            (Tan, "tan"),
            (Sinh, "sinh"),
            (Cosh, "cosh"),
            (Tanh, "tanh"),
            (Atan, "atan"),
            (Abs, "abs"),
        ]
    };

    /// The derivative at x, given the function's value `value`.
    pub fn slope<A: Algebra>(self, x: A, value: A) -> A {
        let one = A::from(1.0);
        match self {
            Function::Sqrt => A::from(0.5) / value,
            Function::Exp => value,
            Function::Ln => one / x,
            Function::Sin => x.call(Function::Cos),
            Function::Cos => -x.call(Function::Sin),
            Function::Tan => one + value * value,
            Function::Sinh => x.call(Function::Cosh),
            Function::Cosh => x.call(Function::Sinh),
            Function::Tanh => one - value * value,
            Function::Atan => one / (one + x * x),
            Function::Abs => A::from(x.real().signum()),
        }
    }
}

/// The arithmetic of expressions: plain numbers, or numbers that carry derivatives.
pub trait Algebra:
    Copy
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The number without its derivatives.
    fn real(self) -> f64;
    /// Applies a function.
    fn call(self, function: Function) -> Self;
    /// An integer power.
    fn whole_power(self, exponent: i32) -> Self;
    /// The smaller of two numbers, the first if they are equal.
    fn least(self, other: Self) -> Self {
        if other.real() < self.real() { other } else { self }
    }
    /// The larger of two numbers, the first if they are equal.
    fn most(self, other: Self) -> Self {
        if other.real() > self.real() { other } else { self }
    }
    /// The derivative n xⁿ⁻¹ of an integer power.
    fn power_slope(self, exponent: i32) -> Self {
        if exponent == 0 { Self::from(0.0) } else { self.whole_power(exponent - 1) * f64::from(exponent) }
    }
}

impl<D: Number> Algebra for D {
    fn real(self) -> f64 {
        self.re()
    }

    fn call(self, function: Function) -> D {
        match function {
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            Function::Tanh => self.tanh(),
            Function::Atan => self.atan(),
            Function::Abs => self * self.re().signum(),
        }
    }

    fn whole_power(self, exponent: i32) -> D {
        self.powi(exponent)
    }
}

/// One operation; its operands are indices of earlier operations in the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// A number in the text.
    Number(f64),
    /// A local quantity, by its index among [`Variable`](super::Variable)s.
    Variable(u16),
    /// A uniform number: a parameter of the cell, or a constant of the law.
    Uniform(u16),
    Negate(u16),
    Add(u16, u16),
    Subtract(u16, u16),
    Multiply(u16, u16),
    Divide(u16, u16),
    Least(u16, u16),
    Most(u16, u16),
    Power(u16, u16),
    WholePower(u16, i32),
    Call(Function, u16),
}

/// Largest number of operations of a law.
pub(super) const MOST_STEPS: usize = 2000;

/// The operations of all expressions of a law.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    steps: Vec<Step>,
    /// Indices of the results, in the order of [`Expression`](super::Expression); `None` if the law lacks the expression.
    pub(super) results: [Option<u16>; 4],
    /// Number of operations up to the end of the first expression, the moment, because the others need its value.
    first: usize,
}

impl Program {
    /// Adds an operation unless it is already in the list; `None` if the list is full.
    pub(super) fn add(&mut self, step: Step) -> Option<u16> {
        let step = self.folded(step);
        if let Some(known) = self.steps.iter().position(|other| *other == step) {
            return Some(known as u16);
        }
        (self.steps.len() < MOST_STEPS).then(|| {
            self.steps.push(step);
            (self.steps.len() - 1) as u16
        })
    }

    /// The result of an operation on constants, or the operation itself.
    fn folded(&self, step: Step) -> Step {
        let number = |at: u16| if let Step::Number(x) = self.steps[usize::from(at)] { Some(x) } else { None };
        let both = |a, b, of: fn(f64, f64) -> f64| number(a).zip(number(b)).map(|(a, b)| of(a, b));
        let value = match step {
            Step::Negate(a) => number(a).map(|a| -a),
            Step::Add(a, b) => both(a, b, |a, b| a + b),
            Step::Subtract(a, b) => both(a, b, |a, b| a - b),
            Step::Multiply(a, b) => both(a, b, |a, b| a * b),
            Step::Divide(a, b) => both(a, b, |a, b| a / b),
            Step::Power(a, b) => match number(b) {
                Some(n) if n.fract() == 0.0 && n.abs() <= 100.0 => return self.folded(Step::WholePower(a, n as i32)),
                _ => both(a, b, f64::powf),
            },
            Step::WholePower(a, n) => number(a).map(|a| a.powi(n)),
            _ => None,
        };
        value.map_or(step, Step::Number)
    }

    /// Ends an expression with its result.
    pub(super) fn end(&mut self, which: usize, result: u16) {
        self.results[which] = Some(result);
        if which == 0 {
            self.first = self.steps.len();
        }
    }

    /// The local quantities that an expression uses, by their indices.
    pub(super) fn uses(&self, which: usize) -> Vec<u16> {
        let (mut used, mut found) = (vec![false; self.steps.len()], Vec::new());
        if let Some(result) = self.results[which] {
            used[usize::from(result)] = true;
        }
        for at in (0..self.steps.len()).rev().filter(|at| self.results[which].is_some_and(|r| *at <= usize::from(r))) {
            if !used[at] {
                continue;
            }
            match self.steps[at] {
                Step::Variable(variable) => found.push(variable),
                Step::Number(_) | Step::Uniform(_) => {}
                Step::Negate(a) | Step::WholePower(a, _) | Step::Call(_, a) => used[usize::from(a)] = true,
                Step::Add(a, b)
                | Step::Subtract(a, b)
                | Step::Multiply(a, b)
                | Step::Divide(a, b)
                | Step::Least(a, b)
                | Step::Most(a, b)
                | Step::Power(a, b) => (used[usize::from(a)], used[usize::from(b)]) = (true, true),
            }
        }
        found
    }

    /// Whether an expression uses a parameter or a constant, given by its index.
    pub(super) fn names_uniform(&self, index: usize) -> bool {
        // The parser adds an operation for each name.
        self.steps.iter().any(|step| matches!(step, Step::Uniform(k) if usize::from(*k) == index))
    }

    /// The number of operations up to the end of the first and of the second expression.
    pub(super) fn parts(&self) -> [usize; 2] {
        let second = self.results[1].map_or(0, |at| usize::from(at) + 1);
        [self.first, second.max(self.first)]
    }

    /// Continues after the operations with results in `values`, up to a given number of operations or to the last.
    pub(super) fn run<A: Algebra>(&self, until: Option<usize>, place: &[A], uniform: &[A], values: &mut Vec<A>) {
        let steps = &self.steps[values.len()..until.unwrap_or(self.steps.len())];
        for step in steps {
            let at = |index: u16| values[usize::from(index)];
            let value = match *step {
                Step::Number(x) => A::from(x),
                Step::Variable(k) => place[usize::from(k)],
                Step::Uniform(k) => uniform[usize::from(k)],
                Step::Negate(a) => -at(a),
                Step::Add(a, b) => at(a) + at(b),
                Step::Subtract(a, b) => at(a) - at(b),
                Step::Multiply(a, b) => at(a) * at(b),
                Step::Divide(a, b) => at(a) / at(b),
                Step::Least(a, b) => at(a).least(at(b)),
                Step::Most(a, b) => at(a).most(at(b)),
                Step::Power(a, b) => (at(a).call(Function::Ln) * at(b)).call(Function::Exp),
                Step::WholePower(a, n) => at(a).whole_power(n),
                Step::Call(function, a) => at(a).call(function),
            };
            values.push(value);
        }
    }

    /// The value of an expression after the run; 0 if the law lacks it.
    pub(super) fn result<A: Algebra>(&self, which: usize, values: &[A]) -> A {
        self.results[which].map_or(A::from(0.0), |at| values[usize::from(at)])
    }
}
