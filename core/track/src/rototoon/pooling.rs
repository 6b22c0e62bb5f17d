//! The three steps that make the pools of a job: from its keys, with the artist's corrections, and with the findings of the
//! joint choice. Each is a pure function of its input.

use super::corrected;
use super::mend::{Extended, Guide, Known, mend};
use super::pool;
use super::pooled::Pooled;
use super::stage::{Kit, Stage};
use super::turns::with_branches;
use crate::contract::error::TrackError;
use crate::contract::job::Job;
use crate::shared::drawings::Drawing;
use std::sync::Arc;

/// The pools of a job that is solved without corrections.
pub(super) fn plain_pools(kit: Kit, job: Job) -> Result<Pooled, TrackError> {
    if job.span.len() == 2 || job.keys[0].is_empty() {
        let drawings = (0..job.span.len()).map(|i| Drawing { first: i, last: i }).collect();
        return Ok(Pooled {
            job,
            drawings,
            models: None,
            pools: Arc::default(),
            carried: Arc::default(),
            path: Vec::new(),
            steps: 0,
            center_reach: Vec::new(),
        });
    }
    let stage = Stage::set(kit, &job, None)?;
    let (pools, path, carried) = with_branches(&stage, pool::fill(&stage)?)?;
    let (drawings, models) = (stage.drawings.clone(), Some(stage.models.clone()));
    let (pools, steps) = (Arc::new(pools), stage.steps_done.into_inner());
    let center_reach = vec![0.0; drawings.len()];
    Ok(Pooled { job, drawings, models, pools, carried: Arc::new(carried), path, steps, center_reach })
}

/// The pools of a job with its corrections, from those without.
pub(super) fn corrected_pools(kit: Kit, job: &Job, plain: &Pooled) -> Result<Pooled, TrackError> {
    let mut stage = Stage::set(kit, job, plain.models.clone())?;
    stage.center_reach = corrected::center_reach(&stage, plain);
    let pools = corrected::extend(&stage, &plain.drawings, &plain.pools)?;
    let path = pool::choose(&stage, &pools);
    let (drawings, models) = (stage.drawings.clone(), Some(stage.models.clone()));
    let (pools, steps) = (Arc::new(pools), stage.steps_done.into_inner());
    let center_reach = stage.center_reach;
    let (job, carried) = (job.clone(), Arc::default());
    Ok(Pooled { job, drawings, models, pools, carried, path, steps, center_reach })
}

/// Pools with the hypotheses that a joint choice adds, and the same before they became shared. `known` are those of the same
/// part by another guide or with other corrections.
pub(super) fn mended_pools(
    kit: Kit,
    source: &Pooled,
    guide: &Guide,
    known: Option<Known>,
) -> Result<(Pooled, Extended), TrackError> {
    let (drawings, models) = (source.drawings.clone(), source.models.clone());
    let extended = if models.is_some() {
        mend(&Stage::set(kit, &source.job, models.clone())?, source, guide, known)?
    } else {
        Extended::unchanged(&source.pools)
    };
    let Pooled { job, steps, center_reach, .. } = source;
    let (job, path, center_reach) = (job.clone(), guide.path().to_vec(), center_reach.clone());
    let (pools, carried) = (extended.pools.clone(), Arc::default());
    Ok((Pooled { job, drawings, models, pools, carried, path, steps: *steps, center_reach }, extended))
}
