// SPDX-License-Identifier: MIT OR Apache-2.0
//! The outputs of a frame: rendered, in the background too, and saved with the scene that they show. Knows nothing of
//! C.

use super::Renderer;
use super::made::Place;
use crate::error::{Error, PARTLY_WRITTEN, Result};
use crate::image::{Attribute, ColourSpace, Effort, Layer, PixelFormat, save_layers};
use crate::job::{Job, JobTarget, OutputFrame, OutputTarget};
use crate::scene::{MOST_OUTPUTS, Made, Output, Region, Scene};
use crate::tracer::{AdapterInfo, FrameRequest, Progress};
use std::borrow::Cow;
use std::path::Path;
use std::time::Instant;

impl Renderer {
    /// The part of the full frame that images of outputs hold. Errors: INVALID_ARGUMENT for images of several sizes, a
    /// region that they overrun, and formats that do not go with the outputs.
    fn check_outputs(&self, targets: &[OutputTarget<'_>], region: Option<Region>) -> Result<Region> {
        let size = |target: &OutputTarget<'_>| [target.target.width(), target.target.height()];
        let Some([width, height]) = targets.first().map(size) else {
            return Err(Error::argument(format!("output count is 0; it must lie in [1, {MOST_OUTPUTS}]")));
        };
        for (index, target) in targets.iter().enumerate() {
            let [w, h] = size(target);
            if [w, h] != [width, height] {
                return Err(Error::argument(format!(
                    "outputs[{index}] image is {w} x {h}; outputs[0] has {width} x {height}, and all must be of one \
                     size"
                )));
            }
            let (given, wanted) = (target.target.format(), target.output.format());
            if let Some(wanted) = wanted.filter(|wanted| *wanted != given) {
                return Err(Error::argument(format!(
                    "outputs[{index}] image format is {given}; its kind takes {wanted}"
                )));
            }
        }
        let region = region.unwrap_or(Region { full_width: width, full_height: height, x: 0, y: 0 });
        region.check_image(width, height)?;
        Ok(region)
    }

    /// The outputs of a frame. Errors: as `check_outputs`; UNSUPPORTED for a spin beyond those of frames; of the
    /// picture, those of `request`.
    fn output_frame<'a>(&self, mut targets: Vec<OutputTarget<'a>>, region: Option<Region>) -> Result<OutputFrame<'a>> {
        let checked = self.check_outputs(&targets, region)?;
        self.scene.hole.check_shown("a frame")?;
        for OutputTarget { output, target, transparent } in &mut targets {
            if *output != Output::Light {
                self.scene.check_one_eye("an output beside the light")?;
            }
            if *output == Output::Light {
                FrameRequest::checked(
                    &self.scene,
                    target.format(),
                    [target.width(), target.height()],
                    *transparent,
                    region,
                )?;
            }
            self.help_to_write(target);
        }
        Ok(OutputFrame::new(targets, checked))
    }

    /// Writes outputs to an EXR file, with all parameters of the scene that the first one's frame showed, which
    /// `parameters` names: of the scene as it is now, and of `region`, where its pixels are of no frame that is
    /// remembered. Errors: as `check_outputs` and [`save_layers`].
    pub fn save_outputs(
        &self,
        targets: &[OutputTarget<'_>],
        region: Option<Region>,
        parameters: impl FnOnce(&Made) -> Vec<(String, Attribute)>,
        path: &Path,
    ) -> Result<()> {
        let made = targets.first().and_then(|first| self.made.of(&first.target));
        let region = self.check_outputs(targets, made.map(Made::region).or(region))?;
        let now;
        let made = match made {
            Some(made) => made,
            None => {
                now = self.scene.made(&region);
                &now
            }
        };
        let AdapterInfo { backend, name, driver, .. } = &self.adapter;
        let about = [("version", env!("CARGO_PKG_VERSION").into()), ("backend", backend.to_string())];
        let about = about.into_iter().chain([("adapter", name.clone()), ("driver", driver.clone())]);
        let about = about.map(|(name, text)| (format!("bhr.{name}"), Attribute::Text(text)));
        let attributes = about.chain(parameters(made)).collect::<Vec<_>>();
        let layers = targets.iter().enumerate().map(|(index, OutputTarget { output, target, .. })| {
            if *output == Output::Light && target.format() == PixelFormat::R32F {
                return Err(Error::argument(format!(
                    "outputs[{index}] image format is R32F: in files of layers a view's values are the kind VIEW"
                )));
            }
            Ok(Layer { channels: output.channels(), image: target.as_image_ref() })
        });
        save_layers(&layers.collect::<Result<Vec<_>>>()?, (&attributes, ColourSpace::Rec709), Effort::default(), path)
    }

    /// Renders the outputs of one frame; `region` as in [`Self::render`].
    ///
    /// Errors: as [`Self::render`]; INVALID_ARGUMENT for images of several sizes, or of formats that do not go with
    /// their outputs.
    pub fn render_outputs(
        &mut self,
        targets: Vec<OutputTarget<'_>>,
        region: Option<Region>,
        progress: &mut Progress<'_>,
    ) -> Result<()> {
        let start = Instant::now();
        let mut frame = self.output_frame(targets, region)?;
        let scene = self.seen_in(&frame)?;
        let rendered = frame.render(&mut self.tracer.lock(), &scene, progress);
        self.made.remember(&self.scene, &frame.region(), frame.images().map(Place::of));
        let stats = rendered.map_err(|mut error| {
            if frame.is_touched() {
                error.message += PARTLY_WRITTEN;
            }
            error
        })?;
        self.stats.publish(stats, start.elapsed());
        Ok(())
    }

    /// Orders the outputs of a frame, as [`Self::render_in_background`] does a picture. Errors: as there, and as
    /// [`Self::render_outputs`].
    pub fn render_outputs_in_background(
        &mut self,
        targets: Vec<OutputTarget<'static>>,
        region: Option<Region>,
    ) -> Result<Job> {
        let frame = self.output_frame(targets, region)?;
        self.scene.lens(&frame.region())?;
        self.check_device()?;
        let scene = self.seen_in(&frame)?.into_owned();
        let (places, region) = (frame.images().map(Place::of).collect::<Vec<_>>(), frame.region());
        let job = self.enqueue(scene, JobTarget::Outputs(frame))?;
        self.made.remember(&self.scene, &region, places);
        Ok(job)
    }

    /// The scene of outputs: with the occluder if one of them is the picture, which alone regards it. Errors: as
    /// [`Self::behind`].
    fn seen_in(&self, frame: &OutputFrame<'_>) -> Result<Cow<'_, Scene>> {
        if frame.has_light() { self.behind(&frame.region(), frame.size()) } else { Ok(Cow::Borrowed(&self.scene)) }
    }
}
