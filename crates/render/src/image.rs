//! Reading a picture back, without blocking a worker.
//!
//! The picture is copied into a mapped buffer whose rows are padded to 256 bytes, as copies demand. On WebGPU the browser
//! resolves the mapping in its own time; natively and on WebGL2 the future polls the device itself.

use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, Waker};

use crate::{Error, Gpu};

#[derive(Default)]
struct State {
    result: Option<Result<(), Error>>,
    waker: Option<Waker>,
}

/// The pixels of a picture, when they arrive: RGBA, 8 bits, top row first, straight alpha.
pub struct Pixels {
    device: wgpu::Device,
    buffer: wgpu::Buffer,
    state: Arc<Mutex<State>>,
    row: usize,
    pitch: usize,
}

impl Pixels {
    /// Copies `texture` (8-bit RGBA with COPY_SRC) into a buffer and asks for it to be mapped.
    pub(crate) fn read(gpu: &Gpu, texture: &wgpu::Texture, mut encoder: wgpu::CommandEncoder) -> Pixels {
        let (width, height) = (texture.width(), texture.height());
        let pitch = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("picture"),
            size: u64::from(pitch) * u64::from(height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(pitch), rows_per_image: None },
            },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        gpu.queue.submit([encoder.finish()]);
        let state: Arc<Mutex<State>> = Arc::default();
        let done = state.clone();
        buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            let mut state = done.lock().unwrap_or_else(PoisonError::into_inner);
            state.result = Some(result.map_err(|e| Error::Readback(e.to_string())));
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        Pixels { device: gpu.device.clone(), buffer, state, row: 4 * width as usize, pitch: pitch as usize }
    }

    fn take(&self) -> Result<Vec<u8>, Error> {
        let mapped = self.buffer.slice(..).get_mapped_range().map_err(|e| Error::Readback(e.to_string()))?;
        let mut pixels = Vec::with_capacity(mapped.len() / self.pitch.max(1) * self.row);
        for row in mapped.chunks_exact(self.pitch) {
            pixels.extend_from_slice(row.get(..self.row).unwrap_or(row));
        }
        drop(mapped);
        self.buffer.unmap();
        Ok(pixels)
    }
}

impl Future for Pixels {
    type Output = Result<Vec<u8>, Error>;

    fn poll(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Self::Output> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).waker = Some(cx.waker().clone());
        // Calls the callback above where the device has to be asked; WebGPU does nothing here.
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        let result = self.state.lock().unwrap_or_else(PoisonError::into_inner).result.take();
        match (result, polled) {
            (Some(Ok(())), _) => Poll::Ready(self.take()),
            (Some(Err(e)), _) => Poll::Ready(Err(e)),
            (None, Err(e)) => Poll::Ready(Err(Error::Readback(e.to_string()))),
            (None, Ok(_)) => Poll::Pending,
        }
    }
}
