//! The six parameter services. ros2-client's own ones cannot describe (no text, no range, no read-only flag), so these
//! are served here; its store keeps the values and publishes `/parameter_events`.

use super::table::{Definition, Range, When};
use super::values::Values;
use futures::StreamExt;
use futures::future::LocalBoxFuture;
use ros2_client::parameters::raw;
use ros2_client::qos::{History, QosProfile, WhenFull};
use ros2_client::rcl_interfaces as msg;
use ros2_client::{Message, Name, Node, NodeOptions, ParameterValue, Server, ServiceMapping, ServiceTypeName};
use std::cell::RefCell;

/// What is done about a change.
#[derive(Clone, Copy)]
pub struct Change<'a> {
    /// Called with the new values before they count; a reason refuses them.
    pub check: &'a dyn Fn(&Values) -> Result<(), String>,
    /// Called with the new values once they count.
    pub applied: &'a dyn Fn(&Values),
}

/// The servers.
pub struct ParameterServers {
    get: Server<msg::GetParametersRequest, msg::GetParametersResponse>,
    types: Server<msg::GetParameterTypesRequest, msg::GetParameterTypesResponse>,
    list: Server<msg::ListParametersRequest, msg::ListParametersResponse>,
    describe: Server<msg::DescribeParametersRequest, msg::DescribeParametersResponse>,
    set: Server<msg::SetParametersRequest, msg::SetParametersResponse>,
    set_atomically: Server<msg::SetParametersRequest, msg::SetParametersAtomicallyResponse>,
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
    pub async fn serve(&self, node: &Node, values: &RefCell<Values>, change: Change<'_>) {
        let futures: Vec<LocalBoxFuture<()>> = vec![
            Box::pin(answer(&self.get, |r| get(&values.borrow(), &r.names))),
            Box::pin(answer(&self.types, |r| types(&values.borrow(), &r.names))),
            Box::pin(answer(&self.list, |r| list(&values.borrow(), &r))),
            Box::pin(answer(&self.describe, |r| describe(&values.borrow(), &r.names))),
            Box::pin(answer(&self.set, |r| {
                let results = r.parameter.into_iter().map(|p| set(node, values, change, vec![p])).collect();
                msg::SetParametersResponse { results }
            })),
            Box::pin(answer(&self.set_atomically, |r| msg::SetParametersAtomicallyResponse {
                result: set(node, values, change, r.parameter),
            })),
        ];
        futures::future::join_all(futures).await;
    }
}

fn server<Q, R>(node: &mut Node, name: &str, kind: &str) -> Result<Server<Q, R>, String>
where
    Q: Message + Clone + 'static,
    R: Message + 'static,
{
    let qos =
        QosProfile::publisher_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth: 1000 });
    let path = Name::new(&node.fully_qualified_name(), name).map_err(|e| e.to_string())?;
    let kind = ServiceTypeName::new("rcl_interfaces", kind);
    node.create_server(ServiceMapping::Enhanced, &path, &kind, qos.clone(), qos)
        .map_err(|e| format!("cannot create service {path}: {e}"))
}

async fn answer<Q, R>(server: &Server<Q, R>, reply: impl Fn(Q) -> R)
where
    Q: Message + 'static,
    R: Message + 'static,
{
    let mut requests = server.receive_request_stream();
    while let Some(request) = requests.next().await {
        match request {
            Ok((id, request)) => {
                if let Err(e) = server.async_send_response(id, reply(request)).await {
                    tracing::warn!("a parameter service cannot answer: {e}");
                }
            }
            Err(e) => tracing::warn!("a parameter service cannot read its request: {e}"),
        }
    }
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

/// No name has a `.`, so a prefix can only be a whole name, and every depth reaches it.
fn list(values: &Values, request: &msg::ListParametersRequest) -> msg::ListParametersResponse {
    let asked = |name: &str| request.prefixes.is_empty() || request.prefixes.iter().any(|p| p == name);
    let names = values.iter().map(|(d, _)| d.name).filter(|n| asked(n)).map(str::to_string).collect();
    msg::ListParametersResponse { result: msg::ListParametersResult { names, prefixes: vec![] } }
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

/// Sets all or none.
fn set(
    node: &Node,
    values: &RefCell<Values>,
    change: Change,
    parameters: Vec<raw::Parameter>,
) -> raw::SetParametersResult {
    let mut changed = values.borrow().clone();
    for p in &parameters {
        if let Err(reason) = changed.set_running(&p.name, p.value.clone().into()) {
            return raw::SetParametersResult { successful: false, reason };
        }
    }
    if let Err(reason) = (change.check)(&changed) {
        return raw::SetParametersResult { successful: false, reason };
    }
    for p in parameters {
        if let Err(reason) = node.set_parameter(&p.name, p.value.into()) {
            return raw::SetParametersResult { successful: false, reason };
        }
    }
    *values.borrow_mut() = changed;
    (change.applied)(&values.borrow());
    raw::SetParametersResult { successful: true, reason: String::new() }
}
