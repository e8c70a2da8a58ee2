//! How punctual the control loop is: fixed-size histograms that allocate nothing once they are built.

use crate::world::Deviation;
use hdrhistogram::Histogram;
use std::fmt::Write as _;

/// Shortest and longest duration that a histogram tells apart, ns; what is outside is counted at the edge.
const RANGE_NS: (u64, u64) = (1, 100_000_000_000);
/// Two significant digits: percentiles are right to 1 %.
const SIGNIFICANT_DIGITS: u8 = 2;

/// Upper ends of the classes in which the histogram is shown, ns.
const CLASSES_NS: [u64; 12] = [
    10_000,
    20_000,
    50_000,
    100_000,
    200_000,
    500_000,
    1_000_000,
    2_000_000,
    5_000_000,
    10_000_000,
    100_000_000,
    u64::MAX,
];

/// Lateness and step time of control intervals, with what went wrong in real time.
#[derive(Clone, Debug)]
pub struct Timing {
    lateness: Histogram<u64>,
    step: Histogram<u64>,
    /// Control intervals simulated.
    pub intervals: u64,
    /// Intervals that started one control interval or more after their deadline, and were caught up.
    pub overruns: u64,
    /// How often the deadline was set anew because the loop was more than the bound behind.
    pub rebases: u64,
    /// Real time given up by that, ns.
    pub lost_ns: u64,
    /// Estimates of the error of an interval, if they were asked for.
    pub estimates: Estimates,
}

/// Estimates of the errors of control intervals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimates {
    /// Intervals that were estimated.
    pub intervals: u64,
    /// Time that took, ns.
    pub ns: u64,
    /// The largest errors.
    pub worst: Deviation,
}

/// Percentiles of a duration, ns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Percentiles {
    /// Median.
    pub p50: u64,
    /// 99 of 100 are below.
    pub p99: u64,
    /// The largest.
    pub max: u64,
}

impl Timing {
    /// Empty histograms at their final size. `Err` only if the constants of this file contradict each other.
    pub fn new() -> Result<Self, String> {
        let empty =
            || Histogram::new_with_bounds(RANGE_NS.0, RANGE_NS.1, SIGNIFICANT_DIGITS).map_err(|e| e.to_string());
        Ok(Self {
            lateness: empty()?,
            step: empty()?,
            intervals: 0,
            overruns: 0,
            rebases: 0,
            lost_ns: 0,
            estimates: Estimates::default(),
        })
    }

    /// Counts one interval: how long after its deadline it started, and how long it took (ns). Allocates nothing.
    pub fn record(&mut self, lateness_ns: u64, step_ns: u64, period_ns: u64) {
        self.lateness.saturating_record(lateness_ns);
        self.step.saturating_record(step_ns);
        self.intervals += 1;
        self.overruns += u64::from(period_ns > 0 && lateness_ns >= period_ns);
    }

    /// Counts a deadline set anew, with the real time (ns) given up.
    pub fn record_rebase(&mut self, lost_ns: u64) {
        self.rebases += 1;
        self.lost_ns += lost_ns;
    }

    /// Counts the estimate of an interval's error, which took so long, ns.
    pub fn record_estimate(&mut self, ns: u64, error: &Deviation) {
        self.estimates.intervals += 1;
        self.estimates.ns += ns;
        self.estimates.worst.widen(error);
    }

    /// Adds another record to this one.
    pub fn merge(&mut self, other: &Self) {
        // Cannot fail: both have the bounds of this file.
        let _ = self.lateness.add(&other.lateness);
        let _ = self.step.add(&other.step);
        self.intervals += other.intervals;
        self.overruns += other.overruns;
        self.rebases += other.rebases;
        self.lost_ns += other.lost_ns;
        self.estimates.intervals += other.estimates.intervals;
        self.estimates.ns += other.estimates.ns;
        self.estimates.worst.widen(&other.estimates.worst);
    }

    /// Forgets everything; keeps the memory.
    pub fn clear(&mut self) {
        self.lateness.reset();
        self.step.reset();
        (self.intervals, self.overruns, self.rebases, self.lost_ns) = (0, 0, 0, 0);
        self.estimates = Estimates::default();
    }

    /// Wake-up minus deadline.
    pub fn lateness(&self) -> Percentiles {
        percentiles(&self.lateness)
    }

    /// Time that one control interval took to simulate.
    pub fn step(&self) -> Percentiles {
        percentiles(&self.step)
    }

    /// A table for people: microseconds.
    pub fn table(&self) -> String {
        let mut text = format!("{:<12}{:>12}{:>12}{:>12}\n", "µs", "p50", "p99", "max");
        for (name, p) in [("lateness", self.lateness()), ("step time", self.step())] {
            let [p50, p99, max] = [p.p50, p.p99, p.max].map(|ns| ns as f64 * 1e-3);
            let _ = writeln!(text, "{name:<12}{p50:>12.1}{p99:>12.1}{max:>12.1}");
        }
        text
    }

    /// How many intervals were how late, class by class, for people: one line for each class that is not empty.
    pub fn lateness_table(&self) -> String {
        let mut counts = [0; CLASSES_NS.len()];
        for bar in self.lateness.iter_recorded() {
            let class = CLASSES_NS.iter().position(|upto| bar.value_iterated_to() <= *upto);
            counts[class.unwrap_or(CLASSES_NS.len() - 1)] += bar.count_since_last_iteration();
        }
        let mut text = String::new();
        for (upto, count) in CLASSES_NS.into_iter().zip(counts).filter(|(_, count)| *count > 0) {
            let share = count as f64 / self.lateness.len() as f64 * 100.0;
            let upto = if upto == u64::MAX { "more".into() } else { format!("{} µs", upto / 1000) };
            let _ = writeln!(text, "late up to {upto:>10}{count:>12}{share:>11.4} %");
        }
        text
    }
}

fn percentiles(h: &Histogram<u64>) -> Percentiles {
    Percentiles { p50: h.value_at_quantile(0.50), p99: h.value_at_quantile(0.99), max: h.max() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_of_known_durations() {
        let mut t = Timing::new().unwrap();
        for i in 1..=1000 {
            t.record(i * 1000, 5_000, 1_000_000);
        }
        let p = t.lateness();
        assert!((p.p50 as f64 / 500e3 - 1.0).abs() < 0.01, "{p:?}");
        assert!((p.p99 as f64 / 990e3 - 1.0).abs() < 0.01, "{p:?}");
        assert!((p.max as f64 / 1000e3 - 1.0).abs() < 0.01, "{p:?}");
        assert_eq!(t.overruns, 1);
    }

    #[test]
    fn every_interval_is_in_one_class() {
        let mut t = Timing::new().unwrap();
        for ns in [5_000, 7_000, 30_000, 3_000_000, u64::MAX] {
            t.record(ns, 1, 1_000_000);
        }
        let table = t.lateness_table();
        let counts: Vec<u64> =
            table.lines().map(|l| l.split_whitespace().rev().nth(2).unwrap().parse().unwrap()).collect();
        assert_eq!(counts, [2, 1, 1, 1], "{table}");
    }

    #[test]
    fn out_of_range_durations_are_counted_at_the_edge() {
        let mut t = Timing::new().unwrap();
        t.record(u64::MAX, 0, 1);
        assert_eq!(t.intervals, 1);
        assert!(t.lateness().max >= RANGE_NS.1);
    }

    #[test]
    fn merging_adds_and_clearing_forgets() {
        let (mut a, mut b) = (Timing::new().unwrap(), Timing::new().unwrap());
        a.record(1_000, 2_000, 10_000);
        b.record(50_000, 2_000, 10_000);
        b.record_rebase(7);
        a.merge(&b);
        assert_eq!((a.intervals, a.overruns, a.rebases, a.lost_ns), (2, 1, 1, 7));
        b.clear();
        assert_eq!((b.intervals, b.lateness().max), (0, 0));
    }
}
