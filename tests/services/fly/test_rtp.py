"""Video by RTP without RTSP: recognised by its packets, described for the decoder, and shown."""

import random
import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.services.fly.rtp import RtpVideo, is_transport_stream, listen, read_sdp, recognised, rtp_of
from groundstation.services.fly.video import VideoStream, typed_video, video_url
from planning.base.errors import InputError
from tests.services.fly.rtp_sender import film_packets, packets, sent_by_rtp
from tests.services.fly.test_video import is_film, wait_for

GSTREAMER = """v=0
o=- 1188340656180883 1 IN IP4 127.0.0.1
s=Session streamed by GStreamer
c=IN IP4 127.0.0.1
t=0 0
m=audio 5700 RTP/AVP 0
a=rtpmap:96 OPUS/48000
m=video 5600 RTP/AVP 97
a=rtpmap:97 H264/90000
a=fmtp:97 packetization-mode=1;sprop-parameter-sets=Z0LADdoCAJ8B,aM48gA==;profile-level-id=42C00D
a=control:track1
"""


def test_the_film_is_recognised_as_it_is_sent():
    sent = [packet for number in range(3) for packet in film_packets(number, 101)]
    assert recognised(sent, "127.0.0.1", 5600) == RtpVideo("0.0.0.0", 5600, "H264", 101)
    assert recognised(sent[3:9], "239.1.2.3", 5600) == RtpVideo("239.1.2.3", 5600, "H264", 101), "pieces of a slice"


@pytest.mark.parametrize(
    ("units", "encoding"),
    [
        ([b"\x40\x01", b"\x42\x01", b"\x44\x01", b"\x62\x01\x93"], "H265"),
        ([b"\x02\x01", b"\x02\x01", b"\x4e\x01"], "H265"),
        ([b"\x67\x42", b"\x68\xce", b"\x65\x88", b"\x41\x9a"], "H264"),
        ([b"\x7c\x85", b"\x7c\x05", b"\x5c\x41"], "H264"),
        ([b"\x78\x00"], "H264"),
    ],
)
def test_encodings_are_told_by_their_units(units, encoding):
    sent = list(packets([unit + bytes(40) for unit in units], 0, 0, 98))
    assert recognised(sent, "0.0.0.0", 5600) == RtpVideo("0.0.0.0", 5600, encoding, 98)


def test_headers_of_any_length_are_passed_over():
    (packet,) = packets([b"\x67\x42" + bytes(30)], 0, 0, 96)
    longer = bytes([packet[0] | 0x12]) + packet[1:12] + bytes(8) + b"\xbe\xde\0\x01" + bytes(4) + packet[12:]
    assert recognised([longer], "0.0.0.0", 1).encoding == "H264"


def test_static_types_are_those_of_the_standard_and_noise_is_nothing():
    assert recognised(list(packets([bytes(40)], 0, 0, 33)), "0.0.0.0", 1).encoding == "MP2T"
    assert recognised(list(packets([bytes(40)], 0, 0, 26)), "0.0.0.0", 1).encoding == "JPEG"
    assert recognised(list(packets([bytes(40)], 0, 0, 0)), "0.0.0.0", 1) is None, "audio"
    assert recognised([], "0.0.0.0", 1) is None
    assert is_transport_stream((b"\x47" + bytes(187)) * 7)
    assert not is_transport_stream(b"\x47" + bytes(100))


@given(st.integers(0, 2**32 - 1))
def test_whatever_arrives_is_recognised_or_is_not(seed):
    rng = random.Random(seed)
    sent = [bytearray(packet) for packet in film_packets(0)[:6]]
    for packet in sent:
        for _ in range(rng.randint(0, 5)):
            packet[rng.randrange(len(packet))] = rng.randrange(256)
        del packet[rng.randrange(1, len(packet)) :]
    found = recognised(map(bytes, sent), "0.0.0.0", 5600)
    assert found is None or rtp_of(found.url) == found


def test_a_description_is_read_and_written_anew(tmp_path):
    found = read_sdp(GSTREAMER, "cam.sdp")
    assert found == RtpVideo("0.0.0.0", 5600, "H264", 97, "Z0LADdoCAJ8B,aM48gA==")
    assert rtp_of(found.url) == found
    lines = found.sdp().splitlines()
    assert "m=video 5600 RTP/AVP 97" in lines
    assert "a=fmtp:97 packetization-mode=1;sprop-parameter-sets=Z0LADdoCAJ8B,aM48gA==" in lines
    path = tmp_path / "cam.sdp"
    path.write_text(GSTREAMER)
    assert typed_video(f" {path} ") == found.url
    assert video_url(found.url) == found.url
    path.write_text(GSTREAMER.replace("Z0LADdoCAJ8B", "Z" * 400))
    assert typed_video(str(path)) == "rtp://0.0.0.0:5600/H264/97"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "expected it to begin with v=0"),
        ("v=0\r\nm=audio 5000 RTP/AVP 0", "describes no video"),
        ("v=0\nm=video 5600 RTP/AVP 96\na=rtpmap:96 VP8/90000", "as 'VP8'; expected one of H264"),
        ("v=0\nm=video 99999 RTP/AVP 96\na=rtpmap:96 H264/90000", "expected one of"),
        ("v=0\nm=video 5600 RTP/AVP 12\na=rtpmap:12 H264/90000", "expected one of"),
        ("ffconcat version 1.0\nfile /etc/passwd", "expected it to begin with v=0"),
    ],
)
def test_what_is_no_description_of_a_video_is_refused(text, told, tmp_path):
    path = tmp_path / "cam.sdp"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        typed_video(str(path))


def test_nothing_of_a_description_but_its_numbers_reaches_the_decoder():
    evil = GSTREAMER.replace("c=IN IP4 127.0.0.1", "c=IN IP4 239.1.1.1/127").replace(
        "a=control:track1", "a=control:file:///etc/passwd\na=source-filter: incl IN IP4 * 1.2.3.4\n"
    )
    assert read_sdp(evil, "x").sdp() == RtpVideo("239.1.1.1", 5600, "H264", 97, "Z0LADdoCAJ8B,aM48gA==").sdp()


@pytest.mark.parametrize(
    "url",
    [
        "rtp://0.0.0.0:5600/H264?sprop-parameter-sets=a\r\na=x",
        "rtp://0.0.0.0:0/H264",
        "rtp://0.0.0.0:5600/VP8",
        "rtp://0.0.0.0:5600/H264/12",
        "rtp://cam.example:5600/H264",
        "rtp://0.0.0.0:5600",
    ],
)
def test_addresses_that_are_none_are_refused(url):
    assert rtp_of(url) is None
    with pytest.raises(InputError):
        video_url(url)


def test_listening_ends_with_what_is_known_and_when_asked():
    with sent_by_rtp(102) as port:
        assert listen("0.0.0.0", port, lambda: False) == RtpVideo("0.0.0.0", port, "H264", 102)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        silent = probe.getsockname()[1]
    assert listen("0.0.0.0", silent, lambda: True) is None


@pytest.mark.slow
@pytest.mark.parametrize("form", ["udp://0.0.0.0:{}", "rtp://0.0.0.0:{}/H264/96"])
def test_h264_by_rtp_is_shown(form):
    """As ArduPilot's and Gazebo's companion boards send it, to a port and without a word."""
    with sent_by_rtp() as port:
        stream = VideoStream(video_url(form.format(port)), 128)
        try:
            wait_for(lambda: (found := stream.latest()) is not None and is_film(found.picture))
        finally:
            stream.close()
