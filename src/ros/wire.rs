//! Mends one byte of what RustDDS sends, so that service replies above 1.4 kB arrive: docs/decisions/0032.
//!
//! RustDDS 0.15.1 writes the inline QoS of a DATA_FRAG submessage with the tag byte of an `Option` before it
//! (`messages/submessages/data_frag.rs`); no reader understands that. Only replies have both fragments and inline QoS. The
//! program's own `sendto` stands before that of the C library, and takes the byte out.

use std::borrow::Cow;

/// RTPS 2.5, 9.4.5.4.
const DATA_FRAG: u8 = 0x16;
const LITTLE_ENDIAN: u8 = 0x01;
const HAS_INLINE_QOS: u8 = 0x02;
const HEADER: usize = 20;
/// Of a submessage.
const SUBHEADER: usize = 4;
/// From the start of a DATA_FRAG's content to its inline QoS.
const TO_INLINE_QOS: usize = 32;
/// What RustDDS puts first into the inline QoS of a reply: PID_RELATED_SAMPLE_IDENTITY and its length.
const RELATED_SAMPLE_IDENTITY: [u8; 4] = [0x83, 0x00, 0x18, 0x00];
/// The tag of `Some`.
const TAG: u8 = 1;

/// The datagram without tag bytes before inline QoS; the very same where there are none.
fn mended(datagram: &[u8]) -> Cow<'_, [u8]> {
    if !datagram.starts_with(b"RTPS") {
        return Cow::Borrowed(datagram);
    }
    let (mut whole, mut at) = (Cow::Borrowed(datagram), HEADER);
    while let Some(&[kind, flags, low, high]) = whole.get(at..at + SUBHEADER) {
        let qos = at + SUBHEADER + TO_INLINE_QOS;
        let tagged = kind == DATA_FRAG
            && flags & (LITTLE_ENDIAN | HAS_INLINE_QOS) == LITTLE_ENDIAN | HAS_INLINE_QOS
            && whole.get(qos) == Some(&TAG)
            && whole.get(qos + 1..qos + 5) == Some(&RELATED_SAMPLE_IDENTITY);
        if tagged {
            // The length of the submessage does not count it.
            whole.to_mut().remove(qos);
        }
        match u16::from_le_bytes([low, high]) {
            // Up to the end of the datagram.
            0 => break,
            length => at += SUBHEADER + usize::from(length),
        }
    }
    whole
}

/// `sendto` of the C library, but for the byte.
///
/// # Safety
/// As that of the C library: `buffer` has `length` bytes, `address` has `address_length`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sendto(
    socket: libc::c_int,
    buffer: *const libc::c_void,
    length: libc::size_t,
    flags: libc::c_int,
    address: *const libc::sockaddr,
    address_length: libc::socklen_t,
) -> libc::ssize_t {
    let send = |data: *const libc::c_void, length: usize| {
        // SAFETY: the system call with the caller's arguments, or with a shorter copy of the caller's data.
        unsafe {
            libc::syscall(libc::SYS_sendto, socket, data, length, flags, address, address_length) as libc::ssize_t
        }
    };
    if buffer.is_null() || length < HEADER {
        return send(buffer, length);
    }
    // SAFETY: not null, and the caller gives `length` bytes that nobody writes during the call.
    let datagram = unsafe { std::slice::from_raw_parts(buffer.cast::<u8>(), length) };
    match mended(datagram) {
        Cow::Borrowed(_) => send(buffer, length),
        Cow::Owned(shorter) => match send(shorter.as_ptr().cast(), shorter.len()) {
            sent if sent == shorter.len() as libc::ssize_t => length as libc::ssize_t,
            other => other,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn submessage(kind: u8, flags: u8, content: &[u8], counted: usize) -> Vec<u8> {
        let mut all = vec![kind, flags];
        all.extend((counted as u16).to_le_bytes());
        all.extend(content);
        all
    }

    fn fragment(tag: &[u8]) -> Vec<u8> {
        let mut content = vec![7; TO_INLINE_QOS];
        content.extend(tag);
        content.extend(RELATED_SAMPLE_IDENTITY);
        content.extend([9; 100]);
        submessage(DATA_FRAG, 0x03, &content, content.len() - tag.len())
    }

    fn datagram(fragments: [&[u8]; 2]) -> Vec<u8> {
        let mut all = b"RTPS".to_vec();
        all.extend([2; HEADER - 4]);
        all.extend(submessage(0x09, 1, &[3; 8], 8));
        all.extend(fragment(fragments[0]));
        all.extend(submessage(0x0e, 1, &[4; 12], 12));
        all.extend(fragment(fragments[1]));
        all.extend(submessage(0x07, 1, &[5; 28], 28));
        all
    }

    #[test]
    fn just_the_tags_are_taken_out() {
        let right = datagram([&[], &[]]);
        assert!(matches!(mended(&right), Cow::Borrowed(same) if same == right));
        for tags in [[&[TAG][..], &[]], [&[], &[TAG][..]], [&[TAG][..], &[TAG][..]]] {
            assert_eq!(*mended(&datagram(tags)), right);
        }
    }

    #[test]
    fn nothing_else_is_touched() {
        let tagged = datagram([&[TAG], &[]]);
        for cut in 0..tagged.len() {
            let _ = mended(&tagged[..cut]);
        }
        let mut other = tagged.clone();
        other[0] = b'X';
        assert!(matches!(mended(&other), Cow::Borrowed(same) if same == other));
    }
}
