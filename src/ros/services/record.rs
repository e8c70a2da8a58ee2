//! Recording, begun and ended while the node runs.

use crate::ros::messages::{RecordRequest, RecordResponse};
use crate::ros::recording::{Tape, told};
use crate::ros::service::Service;
use crate::ros::topics::Topics;
use chrono::Utc;
use std::path::PathBuf;

/// `record`.
pub struct RecordService {
    service: Service<RecordRequest, RecordResponse>,
    tape: Tape,
}

impl RecordService {
    /// Creates the server.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn new(topics: &mut Topics, tape: &Tape) -> Result<Self, String> {
        Ok(Self { service: topics.service("record", "realnoid/Record")?, tape: tape.clone() })
    }

    /// Answers requests until it is dropped.
    pub async fn serve(&self) {
        self.service
            .serve(async |request| if request.start { self.start(&request.folder) } else { self.stop().await })
            .await;
    }

    fn start(&self, folder: &str) -> RecordResponse {
        let folder = match folder {
            "" => PathBuf::from(Utc::now().format("realnoid_%Y_%m_%d-%H_%M_%S").to_string()),
            named => PathBuf::from(named),
        };
        match self.tape.start(&folder) {
            Ok(report) => {
                let folder = report.folder.display().to_string();
                RecordResponse { success: true, message: format!("records into '{folder}'"), folder }
            }
            Err(message) => RecordResponse { success: false, message, folder: String::new() },
        }
    }

    /// Completing the bag may take a while, in which commands are still listened to.
    async fn stop(&self) -> RecordResponse {
        let tape = self.tape.clone();
        match smol::unblock(move || tape.stop()).await {
            Some(report) => RecordResponse {
                success: report.failed.is_none(),
                message: told(&report),
                folder: report.folder.display().to_string(),
            },
            None => {
                let message = "nothing is recorded at present".into();
                RecordResponse { success: false, message, folder: String::new() }
            }
        }
    }
}
