//! A message that orders something in; the answer, or the refusal, out.

use quatrack::Tick;
use quatrack::link::{BlobError, FromBoard, Received, Refusal, ToBoard, TrajectoryCommand, TrajectoryId};

use super::{Session, Shared};
use crate::flight::Flight;
use crate::kept::Keep;
use crate::laws::Refused;
use crate::stored;

impl<K: Keep> Session<K> {
    pub(super) fn carry_out(
        &mut self,
        received: Received<ToBoard>,
        flight: &mut impl Shared,
        now: Tick,
    ) -> Result<Option<FromBoard>, Refusal> {
        match received.message {
            ToBoard::SelectLaw(law) => flight.with(|flight| flight.select(law)).map(|()| None).map_err(Refusal::from),
            ToBoard::Trajectory(command) => trajectory(command, flight).map(|()| None),
            ToBoard::Arm => flight.with(|flight| flight.arm(now)).map(|()| None).map_err(Refusal::Arm),
            ToBoard::Disarm => {
                flight.with(Flight::disarm);
                Ok(None)
            }
            ToBoard::UploadBegin(begin) => {
                self.uploads.begin(&begin).map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadChunk(chunk) => {
                self.uploads.chunk(&chunk).map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadQuery => {
                self.uploads.progress().map(|progress| Some(FromBoard::Upload(progress))).map_err(Refusal::Upload)
            }
            ToBoard::UploadCommit { id } => self.counted(|session| session.commit(id, flight)).map(|()| None),
            ToBoard::UploadKeep { id } => self.counted(|session| session.keep(id, flight)).map(|()| None),
            _ => Err(Refusal::Unsupported),
        }
    }
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::NoTable => Self::NoTable,
            Refused::Busy => Self::LawChanging,
            Refused::Accept(error) => Self::Blob(BlobError::GainTable(error.into())),
        }
    }
}

fn trajectory(command: TrajectoryCommand, flight: &mut impl Shared) -> Result<(), Refusal> {
    let found = match command {
        TrajectoryCommand::Start(TrajectoryId::Uploaded) => flight.with(|flight| flight.playback.start_uploaded()),
        TrajectoryCommand::Start(id) => {
            // Checked here, where only the link waits for it.
            let player = stored::player(id).ok_or(Refusal::NoTrajectory)?;
            flight.with(|flight| flight.playback.start(player));
            true
        }
        TrajectoryCommand::Pause => flight.with(|flight| flight.playback.pause()),
        TrajectoryCommand::Resume => flight.with(|flight| flight.playback.resume()),
        TrajectoryCommand::Stop => {
            flight.with(|flight| flight.playback.stop());
            true
        }
    };
    if found { Ok(()) } else { Err(Refusal::NoTrajectory) }
}
