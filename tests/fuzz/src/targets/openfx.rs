//! The OpenFX plugin without a host: stored texts, names of parts, pixels, and the pictures of decoded settings.

use crate::given::{self, name, number};
use arbitrary::{Result, Unstructured};
use rototoon::pipeline::Cels;
use rototoon::project::Document;
use rototoon::render::composite::Blend;
use rototoon::scene::{Falloff, FalloffCurve, FrameNumber, Raster};
use rototoon_ofx::ofx::Bounds;
use rototoon_ofx::ofx::effect::Region;
use rototoon_ofx::pixels::{CLEAR, Depth, Format, Layout, Premultiplication};
use rototoon_ofx::roto::parts::selected;
use rototoon_ofx::roto::picture::Picture;
use rototoon_ofx::roto::placement::{Placement, window};
use rototoon_ofx::roto::settings::{Channels, Extent, Output, Settings, SourceAlpha};
use rototoon_ofx::roto::state::PartLook;
use rototoon_ofx::roto::stored;
use std::collections::BTreeMap;

/// The largest side of a window in pixels.
const MOST_SIDE: i32 = 32;

/// Reads the bytes as a text that a host stored, then draws a decoded document.
pub fn openfx(data: &[u8]) {
    let said = String::from_utf8_lossy(data);
    let _ = stored::decode(&said);
    assert_eq!(stored::decode(&stored::encode(&said)).as_deref(), Ok(&*said), "a stored text changed");
    let (text, mut u) = given::text_and_rest(data, "{", given::document::document);
    let Ok(document) = Document::parse(&text, "fuzz") else { return };
    let _ = drawn(&document, &mut u);
}

/// Draws into a window and writes the pixels in a host's format.
fn drawn(document: &Document, u: &mut Unstructured) -> Result<()> {
    let settings = settings(u)?;
    let placement = placement(document, u)?;
    let bounds = bounds(u)?;
    if bounds.is_empty() || bounds.width() > MOST_SIDE as usize {
        return Ok(());
    }
    let looks = looks(document, u)?;
    let settings = Settings { looks, ..settings };
    let (parts, _) = selected(&document.scene.parts, &settings.parts);
    let cels = [Cels::regions(document), Cels::strokes(document)].into_iter().flatten();
    let frame = settings.document_time as FrameNumber;
    let drawn = cels.flat_map(|cels| cels.on(frame, placement.magnification()));
    let drawn = drawn.map(|region| region.moved(|p| placement.place_magnified(p))).collect();
    let named = |names: &str| selected(&document.scene.parts, names).0;
    let picture = Picture::new(&document.scene, &parts, &named, drawn, &settings, &placement);
    let window = window(&bounds);
    let _ = picture.changes_nothing(window);
    if let (Some(found), _) = picture.bounds() {
        let _ = placement.canonical(&found);
    }
    let mut pixels = Raster::from_fn(window.width(), window.height(), |_, _| CLEAR);
    let mut rows = u.int_in_range(0..=255u8)?;
    let mut go_on = || {
        rows = rows.saturating_sub(1);
        rows != 1
    };
    let painted = picture
        .painting(window, &|_, pixels| pixels.fill(CLEAR), &mut go_on)
        .and_then(|mut painting| (0..window.height()).try_for_each(|y| painting.row(y, pixels.row_mut(y), &mut go_on)));
    if painted.is_some() {
        assert!(pixels.data().iter().flatten().all(|v| v.is_finite()), "a pixel is not finite");
    }
    let format = format(u)?;
    let mut bytes = vec![0; format.bytes() * pixels.data().len()];
    format.write(pixels.data(), &mut bytes);
    let mut again = vec![CLEAR; pixels.data().len()];
    format.read(&bytes, &mut again);
    Ok(())
}

/// A number as the plugin reads it of a host: finite, as in `Settings::read`.
fn finite(u: &mut Unstructured) -> Result<f64> {
    number(u).map(|v| if v.is_finite() { v } else { 0.0 })
}

/// How a border falls off, with a rate as the plugin limits it.
fn falloff(u: &mut Unstructured) -> Result<Falloff> {
    let curves = FalloffCurve::ALL.map(|(curve, ..)| Some(curve));
    let rate = if u.ratio(1u8, 2)? { finite(u)?.clamp(Falloff::LEAST, Falloff::MOST) } else { 1.0 };
    Ok(Falloff { rate, curve: *u.choose(&[&curves[..], &[None]].concat())? })
}

fn settings(u: &mut Unstructured) -> Result<Settings> {
    let output = *u.choose(&[
        Output::Cutout,
        Output::Matte,
        Output::Overlay,
        Output::Ids,
        Output::Mattes,
        Output::Painted,
        Output::Cel,
    ])?;
    let parts = if u.ratio(1u8, 4)? { name(u)? } else { String::new() };
    let colour = [0.5, 1.0, 0.0, f32::from(u.arbitrary::<u8>()?) / 255.0];
    let mut shape = [0.0; 4];
    for value in &mut shape {
        *value = if u.ratio(1u8, 2)? { finite(u)? } else { 0.0 };
    }
    let [grow, feather, shutter, width] = shape;
    Ok(Settings {
        output,
        channels: *u.choose(&[Channels::All, Channels::One(0), Channels::One(3)])?,
        source_alpha: *u.choose(&[SourceAlpha::Ignore, SourceAlpha::Multiply, SourceAlpha::Add])?,
        premultiply: u.arbitrary()?,
        use_mask: u.arbitrary()?,
        extent: *u.choose(&[Extent::Shapes, Extent::Source, Extent::Format])?,
        document_time: finite(u)?,
        shown: true,
        parts,
        channel_parts: [name(u)?, name(u)?, String::new(), String::new()],
        drawn_names: String::new(),
        looks: BTreeMap::new(),
        curves: u.arbitrary()?,
        invert: u.arbitrary()?,
        grow: if u.arbitrary()? { -grow } else { grow },
        feather: feather.max(0.0),
        falloff: falloff(u)?,
        shutter: shutter.max(0.0),
        phase: f64::from(u.int_in_range(-4..=4i8)?) / 4.0,
        samples: u.int_in_range(1..=4)?,
        line_width: width.max(0.0),
        line_colour: colour,
    })
}

/// Settings of some of the document's parts, as a host's keys give them.
fn looks(document: &Document, u: &mut Unstructured) -> Result<BTreeMap<String, PartLook>> {
    let mut looks = BTreeMap::new();
    for part in &document.scene.parts {
        if u.ratio(1u8, 2)? {
            continue;
        }
        let (opacity, grow, feather) = (finite(u)?, finite(u)?, finite(u)?);
        let (mode, _) = *u.choose(&Blend::ALL)?;
        let look = PartLook {
            on: u.ratio(3u8, 4)?,
            invert: u.arbitrary()?,
            opacity: opacity.clamp(0.0, 1.0),
            grow,
            feather: feather.max(0.0),
            blend: mode,
            falloff: falloff(u)?,
        };
        looks.insert(part.name.clone(), look);
    }
    Ok(looks)
}

fn placement(document: &Document, u: &mut Unstructured) -> Result<Placement> {
    let footage = &document.scene.footage;
    let mut region = Region { x1: 0.0, y1: 0.0, x2: footage.width as f64, y2: footage.height as f64 };
    let (mut scale, mut aspect) = ([1.0; 2], 1.0);
    if u.ratio(1u8, 4)? {
        region = Region { x1: number(u)?, y1: number(u)?, x2: number(u)?, y2: number(u)? };
        (scale, aspect) = ([number(u)?, number(u)?], number(u)?);
    }
    Ok(Placement::new(footage, &region, aspect, scale, u.arbitrary()?))
}

fn bounds(u: &mut Unstructured) -> Result<Bounds> {
    let start = |u: &mut Unstructured| if u.ratio(1u8, 8)? { u.arbitrary() } else { u.int_in_range(-8..=40) };
    let (x1, y1): (i32, i32) = (start(u)?, start(u)?);
    let (x2, y2) = (u.int_in_range(0..=MOST_SIDE)?, u.int_in_range(0..=MOST_SIDE)?);
    let one = Bounds { x1, y1, x2: x1.saturating_add(x2), y2: y1.saturating_add(y2) };
    let any = Bounds { x1: u.arbitrary()?, y1: u.arbitrary()?, x2: u.arbitrary()?, y2: u.arbitrary()? };
    let _ = (one.shared(&any).is_empty(), any.width(), window(&any));
    Ok(one)
}

fn format(u: &mut Unstructured) -> Result<Format> {
    Ok(Format {
        depth: *u.choose(&[Depth::Byte, Depth::Short, Depth::Half, Depth::Float])?,
        layout: *u.choose(&[Layout::Rgba, Layout::Rgb, Layout::Alpha])?,
        premultiplication: *u.choose(&[
            Premultiplication::Opaque,
            Premultiplication::Multiplied,
            Premultiplication::Separate,
        ])?,
    })
}
