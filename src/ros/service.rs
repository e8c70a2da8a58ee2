//! A service: requests in, one at a time, replies out.

use futures::StreamExt;
use ros2_client::qos::QosProfile;
use ros2_client::service::Server;
use ros2_client::{Message, Name, Node, ServiceMapping, ServiceTypeName};

/// A service with requests `Q` and replies `R`.
pub struct Service<Q: Message + 'static, R: Message + 'static> {
    server: Server<Q, R>,
    name: String,
}

impl<Q: Message + Clone + 'static, R: Message + 'static> Service<Q, R> {
    /// Serves requests of `kind` = `package/Type`.
    ///
    /// # Errors
    /// Names the service that cannot be created.
    pub fn new(node: &mut Node, name: &Name, kind: &str, qos: &QosProfile) -> Result<Self, String> {
        let (package, type_name) = kind.split_once('/').unwrap_or(("", kind));
        let kind_name = ServiceTypeName::new(package, type_name);
        let server = node.create_server(ServiceMapping::Enhanced, name, &kind_name, qos.clone(), qos.clone());
        let server = server.map_err(|e| format!("cannot create service {name}: {e}"))?;
        Ok(Self { server, name: name.to_string() })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self, reply: impl AsyncFn(Q) -> R) {
        self.serve_then(reply, async || {}).await;
    }

    /// The same; `sent` is run after each reply.
    pub async fn serve_then(&self, reply: impl AsyncFn(Q) -> R, sent: impl AsyncFn()) {
        let mut requests = self.server.receive_request_stream();
        while let Some(request) = requests.next().await {
            match request {
                Ok((id, request)) => {
                    let answer = reply(request).await;
                    if let Err(e) = self.server.async_send_response(id, answer).await {
                        tracing::warn!("service {} cannot answer: {e}", self.name);
                    }
                    sent().await;
                }
                Err(e) => tracing::warn!("service {} cannot read its request: {e}", self.name),
            }
        }
    }
}
