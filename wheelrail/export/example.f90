! Forces of a wheelset with 50 kN on each wheel.
!
!     gfortran wheelrail.f90 example.f90 -L. -lwheelrail -Wl,-rpath,'$ORIGIN' -o example && ./example '{"friction": 0.3}'
program example
  use wheelrail
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_char, c_null_char
  implicit none
  integer(c_int) :: element
  real(c_double) :: inputs(wheelrail_inputs), outputs(wheelrail_outputs)
  character(len=1000) :: options
  integer :: number

  options = '{}'
  if (command_argument_count() > 0) call get_command_argument(1, options)
  element = wheelrail_open(trim(options)//c_null_char, c_null_char)
  if (element == 0) call report(0_c_int)
  if (wheelrail_start(element, inputs) /= 0) call report(element)
  if (wheelrail_load(element, wheelrail_each, 50e3_c_double, inputs, outputs) /= 0) call report(element)
  do number = 1, wheelrail_outputs
    print '(es24.16e3)', outputs(number)
  end do
  if (wheelrail_close(element) /= 0) call report(0_c_int)

contains

  subroutine report(failed_element)
    integer(c_int), intent(in) :: failed_element
    character(kind=c_char) :: text(500)
    integer :: length
    text = c_null_char
    if (wheelrail_error(failed_element, text, 500_c_int) /= 0) stop 1
    length = findloc(text, c_null_char, dim=1) - 1
    print '(500a1)', text(1:length)
    stop 1
  end subroutine
end program
