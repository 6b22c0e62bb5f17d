"""Prototypes and constants of the C ABI. Generated from rototoon.h by `cargo xtask generate`; do not edit."""

import ctypes
from typing import Any

HEADER_HASH = 0x78448462b221a0d3

ROTOTOON_ABI_VERSION = 1
ROTOTOON_PAIR = 0
ROTOTOON_SPLIT = 1
ROTOTOON_JOINED = 2
ROTOTOON_VANISHED = 3
ROTOTOON_APPEARED = 4
ROTOTOON_CHAINED = 5
ROTOTOON_STATUS_OK = 0
ROTOTOON_STATUS_ERROR = 1
ROTOTOON_STATUS_CANCELLED = 2
ROTOTOON_STATUS_PANIC = 3
ROTOTOON_STATUS_BAD_ARGUMENT = 4
ROTOTOON_STATUS_BUSY = 5

RototoonProgress = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p, ctypes.c_size_t)

INTEGERS: dict[str, tuple[tuple[int, str, Any], ...]] = {
    "rototoon_suggest_breakdown": (
        (1, "stroke_count", ctypes.c_size_t),
        (5, "drawing_count", ctypes.c_size_t),
        (8, "options_length", ctypes.c_size_t),
    ),
    "rototoon_file_mark": (
        (1, "path_length", ctypes.c_size_t),
    ),
    "rototoon_file_replace": (
        (1, "path_length", ctypes.c_size_t),
        (3, "content_length", ctypes.c_size_t),
        (5, "read_length", ctypes.c_size_t),
    ),
    "rototoon_session_set_fills": (
        (4, "click_count", ctypes.c_size_t),
    ),
    "rototoon_session_set_fills_json": (
        (2, "fills_length", ctypes.c_size_t),
    ),
    "rototoon_session_set_recolours_json": (
        (2, "recolours_length", ctypes.c_size_t),
    ),
    "rototoon_session_fill": (
        (2, "options_length", ctypes.c_size_t),
    ),
    "rototoon_match_contours": (
        (1, "request_length", ctypes.c_size_t),
    ),
    "rototoon_outcomes": (
        (1, "request_length", ctypes.c_size_t),
    ),
    "rototoon_session_new": (
        (1, "document_length", ctypes.c_size_t),
        (3, "folder_length", ctypes.c_size_t),
    ),
    "rototoon_session_open": (
        (1, "path_length", ctypes.c_size_t),
    ),
    "rototoon_session_set_document": (
        (2, "document_length", ctypes.c_size_t),
    ),
    "rototoon_session_save": (
        (2, "path_length", ctypes.c_size_t),
    ),
    "rototoon_session_set_footage": (
        (2, "footage_length", ctypes.c_size_t),
    ),
    "rototoon_session_conform": (
        (2, "options_length", ctypes.c_size_t),
    ),
    "rototoon_session_add_part": (
        (2, "part_length", ctypes.c_size_t),
    ),
    "rototoon_session_remove_part": (
        (2, "part_length", ctypes.c_size_t),
    ),
    "rototoon_session_set_key": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
        (5, "value_count", ctypes.c_size_t),
    ),
    "rototoon_session_remove_key": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
    ),
    "rototoon_session_pin": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
        (4, "point", ctypes.c_int32),
    ),
    "rototoon_session_unpin": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
        (4, "point", ctypes.c_int32),
    ),
    "rototoon_session_set_center": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
    ),
    "rototoon_session_clear_center": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
    ),
    "rototoon_session_set_absent": (
        (2, "part_length", ctypes.c_size_t),
        (3, "first", ctypes.c_int32),
        (4, "last", ctypes.c_int32),
        (5, "absent", ctypes.c_int32),
    ),
    "rototoon_session_track": (
        (2, "options_length", ctypes.c_size_t),
    ),
    "rototoon_session_snap": (
        (2, "options_length", ctypes.c_size_t),
    ),
    "rototoon_session_track_of": (
        (2, "part_length", ctypes.c_size_t),
    ),
    "rototoon_session_curves_of": (
        (2, "part_length", ctypes.c_size_t),
        (3, "frame", ctypes.c_int32),
    ),
    "rototoon_fit_strokes": (
        (1, "stroke_count", ctypes.c_size_t),
        (5, "channel_count", ctypes.c_size_t),
    ),
    "rototoon_hidden_lines": (
        (1, "stroke_count", ctypes.c_size_t),
    ),
    "rototoon_capture_clip": (
        (1, "document_length", ctypes.c_size_t),
        (3, "options_length", ctypes.c_size_t),
    ),
    "rototoon_skeleton": (
        (1, "skeleton_length", ctypes.c_size_t),
    ),
    "rototoon_clip_stance": (
        (1, "clips_length", ctypes.c_size_t),
    ),
    "rototoon_import_motion": (
        (1, "motion_length", ctypes.c_size_t),
        (3, "options_length", ctypes.c_size_t),
    ),
    "rototoon_translate_clip": (
        (1, "clips_length", ctypes.c_size_t),
        (3, "options_length", ctypes.c_size_t),
    ),
    "rototoon_reshape": (
        (1, "document_length", ctypes.c_size_t),
        (3, "clips_length", ctypes.c_size_t),
        (5, "options_length", ctypes.c_size_t),
    ),
    "rototoon_library_add": (
        (1, "folder_length", ctypes.c_size_t),
        (3, "clips_length", ctypes.c_size_t),
        (5, "source_length", ctypes.c_size_t),
    ),
    "rototoon_library_add_files": (
        (1, "folder_length", ctypes.c_size_t),
        (3, "files_length", ctypes.c_size_t),
        (5, "options_length", ctypes.c_size_t),
    ),
    "rototoon_library_find": (
        (1, "folder_length", ctypes.c_size_t),
        (3, "wanted_length", ctypes.c_size_t),
    ),
    "rototoon_session_trace": (
        (2, "options_length", ctypes.c_size_t),
    ),
    "rototoon_match_strokes": (
        (1, "stroke_count", ctypes.c_size_t),
        (7, "drawing_count", ctypes.c_size_t),
        (9, "by_hand_count", ctypes.c_size_t),
        (11, "options_length", ctypes.c_size_t),
    ),
    "rototoon_draw_in_betweens": (
        (1, "stroke_count", ctypes.c_size_t),
        (7, "drawing_count", ctypes.c_size_t),
        (10, "by_hand_count", ctypes.c_size_t),
        (12, "options_length", ctypes.c_size_t),
    ),
}
"""For each function its whole numbers: index, name and type. ctypes wraps numbers that do not fit."""


def declare(library: ctypes.CDLL) -> None:
    """Sets result and argument types of every function."""
    library.rototoon_suggest_breakdown.restype = ctypes.c_int32
    library.rototoon_suggest_breakdown.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_file_mark.restype = ctypes.c_int32
    library.rototoon_file_mark.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_file_replace.restype = ctypes.c_int32
    library.rototoon_file_replace.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_fills.restype = ctypes.c_int32
    library.rototoon_session_set_fills.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_fills_json.restype = ctypes.c_int32
    library.rototoon_session_set_fills_json.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_fills.restype = ctypes.c_int32
    library.rototoon_session_fills.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_recolours.restype = ctypes.c_int32
    library.rototoon_session_recolours.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_recolours_json.restype = ctypes.c_int32
    library.rototoon_session_set_recolours_json.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_fill.restype = ctypes.c_int32
    library.rototoon_session_fill.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_filled.restype = ctypes.c_int32
    library.rototoon_session_filled.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_filled_read.restype = ctypes.c_int32
    library.rototoon_filled_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_filled_names.restype = ctypes.c_int32
    library.rototoon_filled_names.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_filled_free.restype = None
    library.rototoon_filled_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_abi_version.restype = ctypes.c_uint32
    library.rototoon_abi_version.argtypes = []
    library.rototoon_header_hash.restype = ctypes.c_uint64
    library.rototoon_header_hash.argtypes = []
    library.rototoon_version.restype = ctypes.c_int32
    library.rototoon_version.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_release.restype = ctypes.c_int32
    library.rototoon_release.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_parameters.restype = ctypes.c_int32
    library.rototoon_parameters.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_match_contours.restype = ctypes.c_int32
    library.rototoon_match_contours.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_outcomes.restype = ctypes.c_int32
    library.rototoon_outcomes.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_text_read.restype = ctypes.c_int32
    library.rototoon_text_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_text_free.restype = None
    library.rototoon_text_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_track_read.restype = ctypes.c_int32
    library.rototoon_track_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_track_free.restype = None
    library.rototoon_track_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_curves_read.restype = ctypes.c_int32
    library.rototoon_curves_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_curves_free.restype = None
    library.rototoon_curves_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_session_new.restype = ctypes.c_int32
    library.rototoon_session_new.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_open.restype = ctypes.c_int32
    library.rototoon_session_open.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_free.restype = None
    library.rototoon_session_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_session_document.restype = ctypes.c_int32
    library.rototoon_session_document.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_document.restype = ctypes.c_int32
    library.rototoon_session_set_document.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_save.restype = ctypes.c_int32
    library.rototoon_session_save.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_footage.restype = ctypes.c_int32
    library.rototoon_session_set_footage.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_parts.restype = ctypes.c_int32
    library.rototoon_session_parts.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_conform.restype = ctypes.c_int32
    library.rototoon_session_conform.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_add_part.restype = ctypes.c_int32
    library.rototoon_session_add_part.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_remove_part.restype = ctypes.c_int32
    library.rototoon_session_remove_part.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_key.restype = ctypes.c_int32
    library.rototoon_session_set_key.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_session_remove_key.restype = ctypes.c_int32
    library.rototoon_session_remove_key.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_void_p,
    ]
    library.rototoon_session_pin.restype = ctypes.c_int32
    library.rototoon_session_pin.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_double,
        ctypes.c_double,
        ctypes.c_void_p,
    ]
    library.rototoon_session_unpin.restype = ctypes.c_int32
    library.rototoon_session_unpin.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_center.restype = ctypes.c_int32
    library.rototoon_session_set_center.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_double,
        ctypes.c_double,
        ctypes.c_void_p,
    ]
    library.rototoon_session_clear_center.restype = ctypes.c_int32
    library.rototoon_session_clear_center.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_void_p,
    ]
    library.rototoon_session_set_absent.restype = ctypes.c_int32
    library.rototoon_session_set_absent.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_int32,
        ctypes.c_void_p,
    ]
    library.rototoon_session_track.restype = ctypes.c_int32
    library.rototoon_session_track.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_snap.restype = ctypes.c_int32
    library.rototoon_session_snap.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_track_of.restype = ctypes.c_int32
    library.rototoon_session_track_of.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_curves_of.restype = ctypes.c_int32
    library.rototoon_session_curves_of.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_int32,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_weakest_frame.restype = ctypes.c_int32
    library.rototoon_session_weakest_frame.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_unseen.restype = ctypes.c_int32
    library.rototoon_session_unseen.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_fit_strokes.restype = ctypes.c_int32
    library.rototoon_fit_strokes.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_double,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_guides_read.restype = ctypes.c_int32
    library.rototoon_guides_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_guides_free.restype = None
    library.rototoon_guides_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_hidden_lines.restype = ctypes.c_int32
    library.rototoon_hidden_lines.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_double,
        ctypes.c_double,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_pieces_read.restype = ctypes.c_int32
    library.rototoon_pieces_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_pieces_free.restype = None
    library.rototoon_pieces_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_capture_clip.restype = ctypes.c_int32
    library.rototoon_capture_clip.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_skeleton.restype = ctypes.c_int32
    library.rototoon_skeleton.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_clip_stance.restype = ctypes.c_int32
    library.rototoon_clip_stance.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_import_motion.restype = ctypes.c_int32
    library.rototoon_import_motion.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_translate_clip.restype = ctypes.c_int32
    library.rototoon_translate_clip.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_reshape.restype = ctypes.c_int32
    library.rototoon_reshape.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_library_add.restype = ctypes.c_int32
    library.rototoon_library_add.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
    ]
    library.rototoon_library_add_files.restype = ctypes.c_int32
    library.rototoon_library_add_files.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_library_find.restype = ctypes.c_int32
    library.rototoon_library_find.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_trace.restype = ctypes.c_int32
    library.rototoon_session_trace.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_session_traced.restype = ctypes.c_int32
    library.rototoon_session_traced.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_traced_read.restype = ctypes.c_int32
    library.rototoon_traced_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_traced_fill_colours.restype = ctypes.c_int32
    library.rototoon_traced_fill_colours.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_traced_free.restype = None
    library.rototoon_traced_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_match_strokes.restype = ctypes.c_int32
    library.rototoon_match_strokes.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_matches_read.restype = ctypes.c_int32
    library.rototoon_matches_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_matches_free.restype = None
    library.rototoon_matches_free.argtypes = [
        ctypes.c_void_p,
    ]
    library.rototoon_draw_in_betweens.restype = ctypes.c_int32
    library.rototoon_draw_in_betweens.argtypes = [
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_size_t,
        ctypes.c_void_p,
        ctypes.c_size_t,
        RototoonProgress,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_in_betweens_read.restype = ctypes.c_int32
    library.rototoon_in_betweens_read.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_in_betweens_held.restype = ctypes.c_int32
    library.rototoon_in_betweens_held.argtypes = [
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
        ctypes.c_void_p,
    ]
    library.rototoon_in_betweens_free.restype = None
    library.rototoon_in_betweens_free.argtypes = [
        ctypes.c_void_p,
    ]
