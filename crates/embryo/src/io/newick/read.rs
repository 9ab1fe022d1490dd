//! Reading Newick, in time and memory in proportion to the text, however deep the brackets.

use std::collections::HashMap;
use std::path::Path;

use super::{nested, push_length, push_name};
use crate::input::{InputError, forbidden, read_text, shown};

/// Most nodes that are read: more than any lineage has, and few enough to be held.
pub const MOST_NODES: usize = 4_000_000;

/// One node of a tree in Newick.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NewickNode {
    /// Its name; empty if it has none.
    pub name: String,
    /// The node above it, by its place in [`Newick::nodes`]; none for the root.
    pub mother: Option<usize>,
    /// Length of the branch that leads to it.
    pub length: Option<f64>,
    /// Its comments `[&…]`, one behind the other with their brackets; other comments are passed over.
    pub comments: String,
}

impl NewickNode {
    /// Keys and values of its comments, of NHX (`[&&NHX:key=value:…]`) and of the kind that FigTree writes
    /// (`[&key=value,…]`). Quotes around a value are left out; a key without a value has an empty one.
    ///
    /// ```
    /// use furrow::io::Newick;
    ///
    /// let tree = Newick::parse("(a:1[&&NHX:chi=0.2:founder=AB],b[&range={1,2},by=\"x, y\"])c;", "x.nwk")?;
    /// assert_eq!(tree.nodes()[1].notes(), [("chi", "0.2"), ("founder", "AB")]);
    /// assert_eq!(tree.nodes()[2].notes(), [("range", "{1,2}"), ("by", "x, y")]);
    /// # Ok::<(), furrow::input::InputError>(())
    /// ```
    pub fn notes(&self) -> Vec<(&str, &str)> {
        let mut notes = Vec::new();
        let mut rest = self.comments.as_str();
        while let Some((comment, behind)) = first_comment(rest) {
            match comment.strip_prefix("&&NHX") {
                Some(pairs) => notes.extend(pairs.split(':').filter(|pair| !pair.is_empty()).map(pair)),
                None => notes.extend(split_outside(comment.strip_prefix('&').unwrap_or(comment)).map(pair)),
            }
            rest = behind;
        }
        notes
    }
}

/// What stands in the bracket that a text begins with, and what comes behind it; none if it begins with no bracket, or with
/// one that is not closed.
fn first_comment(text: &str) -> Option<(&str, &str)> {
    let inside = text.strip_prefix('[')?;
    let mut depth = 1_usize;
    let end = inside.find(|c| {
        depth = match c {
            '[' => depth + 1,
            ']' => depth - 1,
            _ => depth,
        };
        depth == 0
    })?;
    Some((&inside[..end], &inside[end + 1..]))
}

fn pair(text: &str) -> (&str, &str) {
    let (key, value) = text.split_once('=').unwrap_or((text, ""));
    let value = value.strip_prefix('"').and_then(|value| value.strip_suffix('"')).unwrap_or(value);
    (key.trim(), value)
}

/// The parts between commas that stand neither in braces nor in quotes.
fn split_outside(text: &str) -> impl Iterator<Item = &str> {
    let (mut braces, mut quoted) = (0_usize, false);
    let mut parts = text.split(move |c| {
        match c {
            '"' => quoted = !quoted,
            '{' => braces += 1,
            '}' => braces = braces.saturating_sub(1),
            _ => {}
        }
        c == ',' && braces == 0 && !quoted
    });
    std::iter::from_fn(move || parts.find(|part| !part.is_empty()))
}

/// A tree as its Newick text gives it: names, branch lengths, comments. Mothers come before their daughters, and daughters in
/// the order of the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Newick {
    nodes: Vec<NewickNode>,
}

impl Newick {
    /// A tree of these nodes, each of which but the first has its mother before it.
    ///
    /// # Errors
    /// The first node of which that is not so.
    pub fn new(nodes: Vec<NewickNode>) -> Result<Newick, usize> {
        let wrong = |(k, node): (usize, &NewickNode)| match node.mother {
            None => k != 0,
            Some(mother) => mother >= k,
        };
        match nodes.iter().enumerate().position(wrong) {
            Some(k) => Err(k),
            None if nodes.is_empty() => Err(0),
            None => Ok(Newick { nodes }),
        }
    }

    /// Reads a file, of at most [`LONGEST`](crate::input::LONGEST) bytes.
    ///
    /// # Errors
    /// Names file, line, column, what stands there and what is allowed.
    pub fn read(path: &Path) -> Result<Newick, InputError> {
        let (text, file) = (read_text(path)?, path.display().to_string());
        match other_format(&text) {
            None => Newick::parse(&text, &file),
            Some((begins, what)) => {
                let reason = format!("it begins with {}, as {what} does", shown(begins));
                Err(InputError::OtherFile { file, wanted: "a Newick file".to_owned(), reason })
            }
        }
    }

    /// Reads one tree; `file` is what errors call the text. Underscores of names without quotes are blanks, as the format has
    /// it. Lengths are finite and not below 0, and no two nodes have the same name.
    ///
    /// ```
    /// use furrow::io::Newick;
    ///
    /// let tree = Newick::parse("((ABa,ABp)AB:1.5,P1)P0;", "x.nwk")?;
    /// assert_eq!(tree.leaves().map(|leaf| tree.nodes()[leaf].name.as_str()).collect::<Vec<_>>(), ["ABa", "ABp", "P1"]);
    /// let error = Newick::parse("((ABa,ABp)AB:1.5,P1", "x.nwk").unwrap_err();
    /// assert_eq!(error.to_string(), "x.nwk:1:20: the text ends where a comma or the bracket ) that closes the one at 1:1 is expected");
    /// # Ok::<(), furrow::input::InputError>(())
    /// ```
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, file: &str) -> Result<Newick, InputError> {
        let mut reader = Reader::new(text, file);
        reader.run()?;
        reader.names_are_unique()?;
        Ok(Newick { nodes: reader.nodes })
    }

    /// All nodes, the root first.
    pub fn nodes(&self) -> &[NewickNode] {
        &self.nodes
    }

    /// The nodes below each node, in the order of the text.
    pub fn daughters(&self) -> Vec<Vec<usize>> {
        let mut daughters = vec![Vec::new(); self.nodes.len()];
        for (k, node) in self.nodes.iter().enumerate() {
            if let Some(mother) = node.mother {
                daughters[mother].push(k);
            }
        }
        daughters
    }

    /// The nodes without any below them, in the order of the nodes.
    pub fn leaves(&self) -> impl Iterator<Item = usize> {
        let mut inner = vec![false; self.nodes.len()];
        self.nodes.iter().filter_map(|node| node.mother).for_each(|mother| inner[mother] = true);
        (0..inner.len()).filter(move |k| !inner[*k])
    }

    /// The tree as text, which is read back as the same tree if its names are free of control characters and its comments
    /// are as they are read.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        let daughters = self.daughters();
        nested(
            0,
            |k| daughters[k].iter().copied(),
            &mut out,
            |k, out| {
                let node = &self.nodes[k];
                // A leaf without a name is told from no leaf at all by its quotes.
                match node.name.is_empty() && daughters[k].is_empty() {
                    true => out.push_str("''"),
                    false => push_name(out, &node.name),
                }
                push_length(out, node.length);
                out.push_str(&node.comments);
            },
        );
        out.push_str(";\n");
        out
    }
}

/// What has been read so far.
struct Reader<'a> {
    text: &'a str,
    file: &'a str,
    /// Bytes read.
    at: usize,
    nodes: Vec<NewickNode>,
    /// Where each node was begun, in bytes.
    begun: Vec<usize>,
    /// Nodes whose brackets are open, and where these are.
    open: Vec<(usize, usize)>,
    /// The node that was read last and can still be given a name, a length or comments; none where a node is to begin.
    current: Option<usize>,
    named: bool,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, file: &'a str) -> Reader<'a> {
        let at = text.len() - text.trim_start_matches('\u{feff}').len();
        Reader { text, file, at, nodes: vec![], begun: vec![], open: vec![], current: None, named: false }
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    /// Line and column of a byte, both from 1.
    fn place(&self, at: usize) -> (usize, usize) {
        let before = self.text.get(..at).unwrap_or(self.text).trim_start_matches('\u{feff}');
        let line = 1 + before.matches('\n').count();
        (line, 1 + before.chars().rev().take_while(|c| *c != '\n').count())
    }

    fn wrong_at(&self, at: usize, message: impl Into<String>) -> InputError {
        let (line, column) = self.place(at);
        InputError::Malformed { file: self.file.to_owned(), line, column, message: message.into() }
    }

    /// The error for what stands here in place of what is expected.
    fn unexpected(&self, expected: &str) -> InputError {
        let found = match self.rest().chars().next() {
            None => format!("the text ends where {expected} is expected"),
            Some(c) => format!("{c:?} stands where {expected} is expected"),
        };
        self.wrong_at(self.at, found)
    }

    /// What may come behind a node.
    fn behind_a_node(&self) -> String {
        match self.open.last() {
            None => "the semicolon ; at the end of the tree".to_owned(),
            Some((_, at)) => {
                let (line, column) = self.place(*at);
                format!("a comma or the bracket ) that closes the one at {line}:{column}")
            }
        }
    }

    fn run(&mut self) -> Result<(), InputError> {
        loop {
            self.skip_blanks()?;
            match self.rest().bytes().next() {
                None if self.nodes.is_empty() => {
                    return Err(self.wrong_at(self.at, "there is no tree: expected one, as in (a,b)c;"));
                }
                None if self.current.is_none() => return Err(self.unexpected("a name or a bracket (")),
                None => return Err(self.unexpected(&self.behind_a_node())),
                Some(b'(') => self.opens()?,
                Some(b',') => self.comma()?,
                Some(b')') => self.closes()?,
                Some(b':') => self.length()?,
                Some(b';') => return self.ends(),
                Some(b']') => return Err(self.unexpected("a name, or a bracket [ before it,")),
                Some(_) => self.name()?,
            }
        }
    }

    fn opens(&mut self) -> Result<(), InputError> {
        if self.current.is_some() {
            return Err(self.unexpected(&self.behind_a_node()));
        }
        let node = self.begin()?;
        self.open.push((node, self.at));
        self.current = None;
        self.at += 1;
        Ok(())
    }

    /// What stands before a comma or a closing bracket is a daughter: a leaf without a name where nothing does. Outside of all
    /// brackets there are no daughters.
    fn leaf_within_brackets(&mut self) -> Result<(), InputError> {
        if self.open.is_empty() {
            return Err(self.unexpected(if self.current.is_some() {
                "the semicolon ; at the end of the tree"
            } else {
                "a name or a bracket ("
            }));
        }
        self.leaf_if_none()?;
        Ok(())
    }

    fn comma(&mut self) -> Result<(), InputError> {
        self.leaf_within_brackets()?;
        self.current = None;
        self.at += 1;
        Ok(())
    }

    fn closes(&mut self) -> Result<(), InputError> {
        self.leaf_within_brackets()?;
        if let Some((node, _)) = self.open.pop() {
            self.current = Some(node);
            self.named = false;
        }
        self.at += 1;
        Ok(())
    }

    fn ends(&mut self) -> Result<(), InputError> {
        if !self.open.is_empty() {
            return Err(self.unexpected(&self.behind_a_node()));
        }
        if self.nodes.is_empty() {
            return Err(self.wrong_at(self.at, "there is no tree before the semicolon: expected one, as in (a,b)c;"));
        }
        self.at += 1;
        // Comments behind the tree are nobody's.
        self.current = None;
        self.skip_blanks()?;
        match self.rest().is_empty() {
            true => Ok(()),
            false => Err(self.unexpected("the end of the text, since one tree is read,")),
        }
    }

    /// A new node below the bracket that is open.
    fn begin(&mut self) -> Result<usize, InputError> {
        if self.nodes.len() >= MOST_NODES {
            return Err(
                self.wrong_at(self.at, format!("there are more than {MOST_NODES} nodes, the most that are read"))
            );
        }
        let mother = self.open.last().map(|(node, _)| *node);
        self.nodes.push(NewickNode { mother, ..NewickNode::default() });
        self.begun.push(self.at);
        self.current = Some(self.nodes.len() - 1);
        self.named = false;
        Ok(self.nodes.len() - 1)
    }

    /// The node that is being read; where none has begun, a leaf without a name.
    fn leaf_if_none(&mut self) -> Result<usize, InputError> {
        match self.current {
            Some(node) => Ok(node),
            None => self.begin(),
        }
    }

    fn name(&mut self) -> Result<(), InputError> {
        let has_length = self.current.is_some_and(|node| self.nodes[node].length.is_some());
        if self.named && self.current.is_some() || has_length {
            return Err(self.unexpected(&format!(
                "{} (a name with blanks or punctuation is in single quotes)",
                self.behind_a_node()
            )));
        }
        let start = self.at;
        let name = match self.rest().starts_with('\'') {
            true => self.quoted()?,
            false => {
                let word = word(self.rest());
                self.at += word.len();
                word.replace('_', " ")
            }
        };
        if let Some(c) = forbidden(&name) {
            return Err(
                self.wrong_at(start, format!("name {}: must be free of control characters, here {c:?}", shown(&name)))
            );
        }
        let end = std::mem::replace(&mut self.at, start);
        let node = self.leaf_if_none()?;
        self.at = end;
        self.begun[node] = start;
        self.nodes[node].name = name;
        self.named = true;
        Ok(())
    }

    fn quoted(&mut self) -> Result<String, InputError> {
        let mut name = String::new();
        let mut rest = self.rest().get(1..).unwrap_or("");
        loop {
            let Some(end) = rest.find('\'') else {
                return Err(self.wrong_at(self.at, "the single quote that opens here is not closed"));
            };
            name.push_str(&rest[..end]);
            rest = &rest[end + 1..];
            match rest.strip_prefix('\'') {
                // A quote that stands twice is one of the name's own.
                Some(more) => {
                    name.push('\'');
                    rest = more;
                }
                None => break,
            }
        }
        self.at = self.text.len() - rest.len();
        Ok(name)
    }

    fn length(&mut self) -> Result<(), InputError> {
        let node = self.leaf_if_none()?;
        if self.nodes[node].length.is_some() {
            return Err(self.unexpected(&self.behind_a_node()));
        }
        self.at += 1;
        self.skip_blanks()?;
        let written = word(self.rest());
        let length = written.parse::<f64>().ok().filter(|length| length.is_finite() && *length >= 0.0);
        let Some(length) = length else {
            let name = match self.nodes[node].name.as_str() {
                "" => "branch length".to_owned(),
                name => format!("branch length of {}", shown(name)),
            };
            let message =
                format!("{name} = {}: must be a finite number of at least 0, as 0.87 or 1e-3", shown(written));
            return Err(self.wrong_at(self.at, message));
        };
        self.nodes[node].length = Some(length);
        self.at += written.len();
        Ok(())
    }

    /// Passes over blanks and comments; those of a node are kept.
    fn skip_blanks(&mut self) -> Result<(), InputError> {
        loop {
            let rest = self.rest();
            self.at += rest.len() - rest.trim_start().len();
            if !self.rest().starts_with('[') {
                return Ok(());
            }
            let Some((comment, behind)) = first_comment(self.rest()) else {
                return Err(self.wrong_at(self.at, "the bracket [ that opens here is not closed"));
            };
            let end = self.text.len() - behind.len();
            if let (true, Some(node)) = (comment.starts_with('&'), self.current) {
                self.nodes[node].comments.push_str(&self.text[self.at..end]);
            }
            self.at = end;
        }
    }

    fn names_are_unique(&self) -> Result<(), InputError> {
        let mut seen = HashMap::new();
        for (k, node) in self.nodes.iter().enumerate().filter(|(_, node)| !node.name.is_empty()) {
            if let Some(first) = seen.insert(node.name.as_str(), k) {
                let (line, column) = self.place(self.begun[first]);
                let name = shown(&node.name);
                let message = format!("name {name}: must be no other cell's; it stands at {line}:{column} too");
                return Err(self.wrong_at(self.begun[k], message));
            }
        }
        Ok(())
    }
}

/// The first line of a text that is evidently of another format, and that format: in Newick it would be the beginning of a
/// strange name.
fn other_format(text: &str) -> Option<(&str, &'static str)> {
    let begun = text.trim_start_matches('\u{feff}').trim_start();
    let what = match begun.chars().next()? {
        '{' => "JSON",
        '<' => "XML",
        '#' => "Nexus, in which the tree is what stands behind =",
        _ => return None,
    };
    Some((begun.lines().next()?, what))
}

/// What is written up to the next blank or mark of the format.
fn word(text: &str) -> &str {
    let end = text.find(|c: char| c.is_whitespace() || "()[]:;,'".contains(c)).unwrap_or(text.len());
    &text[..end]
}
