//! The six parameter services. ros2-client's own ones cannot describe (no text, no range, no read-only flag), so these
//! are served here; its store keeps the values and publishes `/parameter_events`.

use super::table::{Definition, Range, When};
use super::values::Values;
use crate::ros::service::Service;
use crate::ros::topics::stream_qos;
use futures::future::LocalBoxFuture;
use ros2_client::parameters::raw;
use ros2_client::rcl_interfaces as msg;
use ros2_client::{Message, Name, Node, NodeOptions, ParameterValue};
use std::cell::RefCell;

/// What is done about a change.
#[derive(Clone, Copy)]
pub struct Change<'a> {
    /// Called with the new values before they count; a reason refuses them.
    pub check: &'a dyn Fn(&Values) -> Result<(), String>,
    /// Called with the new values once they count.
    pub applied: &'a dyn Fn(&Values),
    /// Called with each parameter that ros2-client announces on `/parameter_events`.
    pub announced: &'a dyn Fn(raw::Parameter),
}

/// Sets parameters, for clients and for services of ours alike: checked, announced and put into force in one way.
#[derive(Clone, Copy)]
pub struct Setter<'a> {
    /// For `/parameter_events`.
    pub node: &'a Node,
    /// In force.
    pub values: &'a RefCell<Values>,
    /// What is done about a change.
    pub change: Change<'a>,
}

/// The servers.
pub struct ParameterServers {
    get: Service<msg::GetParametersRequest, msg::GetParametersResponse>,
    types: Service<msg::GetParameterTypesRequest, msg::GetParameterTypesResponse>,
    list: Service<msg::ListParametersRequest, msg::ListParametersResponse>,
    describe: Service<msg::DescribeParametersRequest, msg::DescribeParametersResponse>,
    set: Service<msg::SetParametersRequest, msg::SetParametersResponse>,
    set_atomically: Service<msg::SetParametersRequest, msg::SetParametersAtomicallyResponse>,
}

/// Declares `values` in ros2-client's store and turns its own services off.
pub fn declare(options: NodeOptions, values: &Values) -> NodeOptions {
    values
        .iter()
        .fold(options.start_parameter_services(false), |o, (d, value)| o.declare_parameter(d.name, value.clone()))
}

impl ParameterServers {
    /// Creates the servers under the node's name.
    pub fn new(node: &mut Node) -> Result<Self, String> {
        Ok(Self {
            get: server(node, "get_parameters", "GetParameters")?,
            types: server(node, "get_parameter_types", "GetParameterTypes")?,
            list: server(node, "list_parameters", "ListParameters")?,
            describe: server(node, "describe_parameters", "DescribeParameters")?,
            set: server(node, "set_parameters", "SetParameters")?,
            set_atomically: server(node, "set_parameters_atomically", "SetParametersAtomically")?,
        })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, setter: Setter<'_>) {
        let values = setter.values;
        let futures: Vec<LocalBoxFuture<()>> = vec![
            Box::pin(self.get.serve(async |r| get(&values.borrow(), &r.names))),
            Box::pin(self.types.serve(async |r| types(&values.borrow(), &r.names))),
            Box::pin(self.list.serve(async |r| list(&values.borrow(), &r))),
            Box::pin(self.describe.serve(async |r| describe(&values.borrow(), &r.names))),
            Box::pin(self.set.serve(async |r| {
                let results = r.parameter.into_iter().map(|p| setter.result(vec![p])).collect();
                msg::SetParametersResponse { results }
            })),
            Box::pin(
                self.set_atomically
                    .serve(async |r| msg::SetParametersAtomicallyResponse { result: setter.result(r.parameter) }),
            ),
        ];
        futures::future::join_all(futures).await;
    }
}

fn server<Q, R>(node: &mut Node, name: &str, kind: &str) -> Result<Service<Q, R>, String>
where
    Q: Message + Clone + 'static,
    R: Message + 'static,
{
    let path = Name::new(&node.fully_qualified_name(), name).map_err(|e| e.to_string())?;
    Service::new(node, &path, &format!("rcl_interfaces/{kind}"), &stream_qos())
}

fn get(values: &Values, names: &[String]) -> msg::GetParametersResponse {
    let value = |name: &String| values.get(name).map_or(ParameterValue::NotSet, |(_, v)| v.clone()).into();
    msg::GetParametersResponse { values: names.iter().map(value).collect() }
}

fn types(values: &Values, names: &[String]) -> msg::GetParameterTypesResponse {
    let kind = |name: &String| {
        values.get(name).map_or(raw::ParameterType::NOT_SET, |(_, v)| ParameterValue::to_parameter_type_raw(v))
    };
    msg::GetParameterTypesResponse { values: names.iter().map(kind).collect() }
}

/// As rclcpp: a prefix is a whole name, or what stands before a `.`; the depth counts the parts of a name behind its prefix, 0 is any.
fn list(values: &Values, request: &msg::ListParametersRequest) -> msg::ListParametersResponse {
    let near = |rest: &str| request.depth == 0 || rest.split('.').count() as u64 <= request.depth;
    let below = |name: &str, prefix: &str| {
        name == prefix || name.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('.')).is_some_and(near)
    };
    let asked = |name: &str| match request.prefixes.as_slice() {
        [] => near(name),
        prefixes => prefixes.iter().any(|prefix| below(name, prefix)),
    };
    let names: Vec<String> = values.iter().map(|(d, _)| d.name).filter(|n| asked(n)).map(str::to_string).collect();
    let mut prefixes: Vec<String> = names.iter().filter_map(|n| Some(n.rsplit_once('.')?.0.to_string())).collect();
    prefixes.dedup();
    msg::ListParametersResponse { result: msg::ListParametersResult { names, prefixes } }
}

fn describe(values: &Values, names: &[String]) -> msg::DescribeParametersResponse {
    let one = |name: &String| match values.get(name) {
        Some((definition, value)) => descriptor(definition, value),
        None => raw::ParameterDescriptor { name: name.clone(), ..blank() },
    };
    msg::DescribeParametersResponse { values: names.iter().map(one).collect() }
}

fn descriptor(d: &Definition, value: &ParameterValue) -> raw::ParameterDescriptor {
    let mut text = raw::ParameterDescriptor {
        name: d.name.into(),
        r#type: ParameterValue::to_parameter_type_raw(value),
        description: if d.unit.is_empty() { d.doc.into() } else { format!("{} Unit: {}.", d.doc, d.unit) },
        additional_constraints: [d.range_text(), d.when_text().into()]
            .into_iter()
            .filter(|s: &String| !s.is_empty())
            .collect::<Vec<_>>()
            .join("; "),
        read_only: d.when != When::Always,
        ..blank()
    };
    match d.range {
        Range::Integer(from_value, to_value) => {
            text.integer_range.push(raw::IntegerRange { from_value, to_value, step: 1 });
        }
        Range::Double(from_value, to_value) => {
            text.floating_point_range.push(raw::FloatingPointRange { from_value, to_value, step: 0.0 });
        }
        _ => {}
    }
    text
}

fn blank() -> raw::ParameterDescriptor {
    raw::ParameterDescriptor {
        name: String::new(),
        r#type: raw::ParameterType::NOT_SET,
        description: String::new(),
        additional_constraints: String::new(),
        read_only: false,
        dynamic_typing: false,
        floating_point_range: vec![],
        integer_range: vec![],
    }
}

impl Setter<'_> {
    /// Sets one parameter.
    ///
    /// # Errors
    /// Why it is refused; nothing has changed then.
    pub fn set(&self, name: &str, value: ParameterValue) -> Result<(), String> {
        self.set_all(vec![raw::Parameter { name: name.into(), value: value.into() }])
    }

    fn result(&self, parameters: Vec<raw::Parameter>) -> raw::SetParametersResult {
        let refused = self.set_all(parameters).err();
        raw::SetParametersResult { successful: refused.is_none(), reason: refused.unwrap_or_default() }
    }

    /// Sets all or none.
    fn set_all(&self, parameters: Vec<raw::Parameter>) -> Result<(), String> {
        let mut changed = self.values.borrow().clone();
        for p in &parameters {
            changed.set_running(&p.name, p.value.clone().into())?;
        }
        (self.change.check)(&changed)?;
        for p in parameters {
            let announced = p.clone();
            self.node.set_parameter(&p.name, p.value.into())?;
            (self.change.announced)(announced);
        }
        *self.values.borrow_mut() = changed;
        (self.change.applied)(&self.values.borrow());
        Ok(())
    }
}
