//! What a bag holds as text.

use std::fmt;

use super::contents::Contents;

impl fmt::Display for Contents {
    /// A line per topic: name, type, messages, and from when to when, s since the first message.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widest = |of: &dyn Fn(&super::TopicSummary) -> usize, head: usize| {
            self.topics.iter().map(of).max().unwrap_or(0).max(head)
        };
        let name = widest(&|topic| topic.name.chars().count(), 5);
        let kind = widest(&|topic| topic.kind.chars().count(), 4);
        writeln!(f, "{:name$}  {:kind$}  {:>8}  {:>9}  {:>9}", "topic", "type", "messages", "from s", "to s")?;
        for topic in &self.topics {
            let [from, to] = topic.span_s;
            let (called, typed) = (&topic.name, &topic.kind);
            writeln!(f, "{called:name$}  {typed:kind$}  {:>8}  {from:>9.2}  {to:>9.2}", topic.messages)?;
        }
        let list = |all: Vec<String>| if all.is_empty() { "none".to_owned() } else { all.join(", ") };
        writeln!(f, "\nscans: {}", list(self.scans.clone()))?;
        let poses = self.poses.iter().map(|pose| format!("{} ({})", pose.option, pose.about));
        write!(f, "poses: {}", list(poses.collect()))
    }
}
