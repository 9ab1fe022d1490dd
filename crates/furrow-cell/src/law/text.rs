//! The grammar of expressions: numbers, names, `+ - * / ^`, parentheses and functions.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/") sign }
//! sign    = ("+" | "-") sign | power
//! power   = atom [ "^" sign ]
//! atom    = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! A hand-written parser can report the position of an error and the expected text, and its result is one
//! list of operations for plain numbers and for all number types with derivatives.

use super::program::{Function, MOST_STEPS, Program, Step};
use furrow_input::{did_you_mean, shown};

/// Largest length of an expression, in bytes.
pub(super) const LONGEST: usize = 4096;
/// Largest nesting depth of parentheses and signs.
const DEEPEST: usize = 60;

/// Largest number of names listed in an error.
const MOST_NAMES: usize = 60;

/// An error in an expression.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionError {
    /// The byte offset of the error.
    pub at: usize,
    /// The error, with the known names.
    pub message: String,
}

/// The names that expressions may use.
pub(super) trait Names {
    /// The operation that reads a name.
    fn named(&self, name: &str) -> Option<Step>;
    /// All names.
    fn all(&self) -> Vec<String>;
}

/// Adds an expression to a program; returns the index of its result.
pub(super) fn compile(text: &str, names: &dyn Names, program: &mut Program) -> Result<u16, ExpressionError> {
    let mut parser = Parser { text, at: 0, depth: 0, names, program };
    if text.len() > LONGEST {
        return parser.fail(0, format!("has {} bytes: must have at most {LONGEST}", text.len()));
    }
    let result = parser.sum()?;
    match parser.next() {
        None => Ok(result),
        Some(')') => parser.fail(parser.at, "a closing parenthesis without an opening one".to_owned()),
        Some(_) => parser.expected("an operator or the end"),
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    names: &'a dyn Names,
    program: &'a mut Program,
}

type Parsed = Result<u16, ExpressionError>;

impl Parser<'_> {
    fn fail<T>(&self, at: usize, message: String) -> Result<T, ExpressionError> {
        Err(ExpressionError { at, message })
    }

    fn expected<T>(&self, wanted: &str) -> Result<T, ExpressionError> {
        let found = match self.text[self.at..].chars().next() {
            None => "the end".to_owned(),
            Some(c) => shown(&c.to_string()),
        };
        self.fail(self.at, format!("expected {wanted}, found {found}"))
    }

    /// The next character that is not blank.
    fn next(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Reads one of several characters.
    fn take(&mut self, of: &[char]) -> Option<char> {
        let found = self.next().filter(|c| of.contains(c))?;
        self.at += found.len_utf8();
        Some(found)
    }

    fn add(&mut self, step: Step) -> Parsed {
        let at = self.at;
        self.program.add(step).map_or_else(|| self.fail(at, format!("more than {MOST_STEPS} operations")), Ok)
    }

    fn sum(&mut self) -> Parsed {
        let mut left = self.product()?;
        while let Some(operator) = self.take(&['+', '-']) {
            let right = self.product()?;
            left = self.add(if operator == '+' { Step::Add(left, right) } else { Step::Subtract(left, right) })?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Parsed {
        let mut left = self.sign()?;
        while let Some(operator) = self.take(&['*', '/']) {
            let right = self.sign()?;
            left = self.add(if operator == '*' { Step::Multiply(left, right) } else { Step::Divide(left, right) })?;
        }
        Ok(left)
    }

    fn sign(&mut self) -> Parsed {
        let Some(sign) = self.take(&['+', '-']) else { return self.power() };
        let of = self.deeper(Parser::sign)?;
        if sign == '-' { self.add(Step::Negate(of)) } else { Ok(of) }
    }

    fn power(&mut self) -> Parsed {
        let base = self.atom()?;
        if self.take(&['^']).is_none() {
            return Ok(base);
        }
        let exponent = self.deeper(Parser::sign)?;
        self.add(Step::Power(base, exponent))
    }

    fn deeper(&mut self, part: fn(&mut Self) -> Parsed) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return self.fail(self.at, format!("more than {DEEPEST} parentheses, signs and powers within each other"));
        }
        let found = part(self);
        self.depth -= 1;
        found
    }

    fn atom(&mut self) -> Parsed {
        match self.next() {
            Some('(') => {
                self.at += 1;
                let inner = self.deeper(Parser::sum)?;
                self.close()?;
                Ok(inner)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            _ => self.expected("a number, a name or an opening parenthesis"),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.take(&[')']).is_some() { Ok(()) } else { self.expected("an operator or a closing parenthesis") }
    }

    fn number(&mut self) -> Parsed {
        let (start, bytes) = (self.at, self.text.as_bytes());
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(|c| c.is_ascii_digit() || *c == b'.') {
                at += 1;
            }
            at
        };
        let mut end = digits(start);
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            if exponent > end + 1 + sign {
                end = exponent;
            }
        }
        let written = &self.text[start..end];
        match written.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.at = end;
                self.add(Step::Number(value))
            }
            _ => self.fail(start, format!("{} is not a finite number", shown(written))),
        }
    }

    fn name(&mut self) -> Parsed {
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        let name = &rest[..length];
        self.at += length;
        let function = Function::ALL.into_iter().find(|(_, known)| *known == name).map(|(function, _)| function);
        let of_two: Option<fn(u16, u16) -> Step> = match name {
            "min" => Some(Step::Least),
            "max" => Some(Step::Most),
            _ => None,
        };
        if self.next() == Some('(') {
            return match (function, of_two) {
                (Some(function), _) => {
                    let [of] = self.arguments(name)?;
                    self.add(Step::Call(function, of))
                }
                (_, Some(step)) => {
                    let [a, b] = self.arguments(name)?;
                    self.add(step(a, b))
                }
                _ => {
                    self.fail(start, format!("unknown function {}: known are {}", shown(name), functions().join(", ")))
                }
            };
        }
        if function.is_some() || of_two.is_some() {
            return self.expected(&format!("the argument of {name} in parentheses"));
        }
        if name == "pi" {
            return self.add(Step::Number(std::f64::consts::PI));
        }
        match self.names.named(name) {
            Some(step) => self.add(step),
            None => {
                let all = self.names.all();
                let nearest = did_you_mean(name, all.iter().map(String::as_str));
                let more = if all.len() > MOST_NAMES { ", …" } else { "" };
                let known = all[..all.len().min(MOST_NAMES)].join(", ");
                self.fail(start, format!("unknown name {}: known are {known}{more}{nearest}", shown(name)))
            }
        }
    }

    /// The arguments of a function.
    fn arguments<const N: usize>(&mut self, name: &str) -> Result<[u16; N], ExpressionError> {
        let opening = self.at;
        self.at += 1;
        let mut given = vec![self.deeper(Parser::sum)?];
        while self.take(&[',']).is_some() {
            given.push(self.deeper(Parser::sum)?);
        }
        self.close()?;
        let count = given.len();
        <[u16; N]>::try_from(given).or_else(|_| {
            self.fail(opening, format!("{name} has {count} arguments: must have {N}, separated by commas"))
        })
    }
}

/// Names of the functions, and of π.
pub(super) fn functions() -> Vec<&'static str> {
    Function::ALL.into_iter().map(|(_, name)| name).chain(["min", "max"]).collect()
}
